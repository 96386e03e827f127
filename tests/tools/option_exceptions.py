# option_exceptions.py - read by check_options.py: what the program has for itself, and what it says otherwise than the header, each with why.

# Rows that fill no field of an option struct: (command, or "*" for all, and the option).
OWN = {
    ("*", "-o"): "names a file", ("*", "--output-dir"): "names a folder", ("*", "--help"): "text", ("*", "--help-all"): "text", ("*", "--json"): "text", ("*", "--quiet"): "text",
    ("*", "--progress"): "text", ("*", "--format"): "of files", ("*", "--output-origin"): "taken off when a file is written",
    ("repair", "--measure"): "bvx_repair_options.samples", ("*", "--shape"): "bvx_read_volume_options.size", ("*", "--skip"): "bvx_read_volume_options.offset",
    ("*", "--voxel-size"): "bvx_read_volume_options.spacing", ("*", "--range"): "arguments of bvx_threshold",
    ("*", "--triangles"): "an array: target_triangles", ("*", "--error"): "an array: target_errors", ("*", "--count"): "how many targets there are",
    ("*", "--no-sharp"): "sharp = 0", ("*", "--keep-vertices"): "vertices = BVX_VERTICES_KEPT", ("*", "--carry"): "bvx_carry", ("*", "--seed"): "an array, or an argument", ("*", "--cut"): "cut.low, cut.high",
    ("*", "--states"): "an argument of octree calls", ("*", "--expand"): "an argument of bvx_octree_expand", ("*", "--samples"): "0 measures nothing, -1 is not given",
    ("*", "--window"): "bvx_window", ("voxelize", "--level"): "an argument of bvx_threshold", ("lod", "--level"): "an argument of bvx_threshold",
    ("faces", "--level"): "an argument of bvx_threshold", ("render", "--level"): "an argument of bvx_threshold", ("convert", "--level"): "an argument of bvx_threshold",
    ("voxelize", "--label"): "an argument of bvx_threshold", ("lod", "--label"): "an argument of bvx_threshold", ("faces", "--label"): "an argument of bvx_threshold",
    ("render", "--label"): "an argument of bvx_threshold", ("convert", "--label"): "an argument of bvx_threshold",
    ("voxelize", "--below"): "an end of bvx_threshold", ("lod", "--below"): "an end of bvx_threshold", ("faces", "--below"): "an end of bvx_threshold",
    ("render", "--below"): "an end of bvx_threshold", ("convert", "--below"): "an end of bvx_threshold",
    ("voxelize", "--least-part"): "bvx_keep_options.at_least", ("faces", "--least-part"): "bvx_keep_options.at_least",
    ("render", "--least-part"): "bvx_keep_options.at_least", ("convert", "--least-part"): "bvx_keep_options.at_least",
    ("voxelize", "--segments"): "another call, bvx_label_voxels", ("voxelize", "--vectors"): "the other way round: no_vectors",
    ("voxelize", "--half-width"): "0 is for bvx_field_options.half_width = infinity", ("fill", "--add-shell"): "a union of grids",
    ("fill", "--connectivity"): "an argument of bvx_grid_fill", ("fill", "--mesh"): "an argument of bvx_find_pockets",
    ("components", "--fill-cavities"): "another call", ("boolean", "--resample"): "another call",
    ("slice", "--axis"): "bvx_slice_options.normal", ("refine", "--base"): "the resolution of the lattice", ("refine", "--resolution"): "of the last level",
    ("lod", "--levels"): "an array: resolutions", ("lod", "--outer-hull"): "parts.least_cavity = UINT64_MAX", ("morph", "--origin"): "of the lattice",
    ("morph", "--value-type"): "an argument of bvx_grid_distance", ("sections", "--block-model"): "names a file", ("sections", "--block"): "of the block model",
    ("sections", "--touching"): "a call of its own, bvx_build_bodies",
    ("info", "--crossings"): "another call", ("info", "--measure"): "another call", ("render", "--compare"): "another call", ("render", "--from"): "bvx_camera.direction",
    ("render", "--voxels"): "the resolution of a solid",
    ("lod", "--normals"): "bvx_write_options.normals", ("repair", "--normals"): "bvx_write_options.normals", ("simplify", "--normals"): "bvx_write_options.normals",
    ("hull", "--normals"): "bvx_write_options.normals", ("hull", "--up"): "bvx_write_options.turn",
    ("*", "--quantize"): "bvx_write_options.quantize", ("*", "--input-up"): "bvx_write_options.turn",
    ("labels", "--only"): "which meshes are written", ("labels", "--up"): "bvx_write_options.turn", ("components", "--up"): "bvx_write_options.turn", ("convert", "--up"): "bvx_write_options.turn", ("lod", "--up"): "bvx_write_options.turn",
    ("sections", "--up"): "bvx_write_options.turn", ("boolean", "--up"): "bvx_write_options.turn", ("morph", "--up"): "bvx_write_options.turn",
    ("simplify", "--up"): "bvx_write_options.turn", ("refine", "--up"): "bvx_write_options.turn", ("fill", "--up"): "bvx_write_options.turn",
    ("faces", "--up"): "bvx_write_options.turn", ("repair", "--up"): "bvx_write_options.turn",
}

# Defaults that the program sets where the library leaves a choice open.
LATER = {
    ("bvx_lattice_options", "resolution", "--resolution of voxelize"): "a lattice must be told; 256 is that of repair",
    ("bvx_lattice_options", "resolution", "--resolution of faces"): "likewise",
    ("bvx_lattice_options", "resolution", "--resolution of morph"): "likewise",
    ("bvx_lod_options", "method", "--method of lod"): "collapse is bvx_build_levels, which is no method of bvx_build_lods",
}

# Choices of the program whose number is not the field's: from the place among the names, and the base.
BY_INDEX = {
    ("bvx_keep_options", "connectivity"): lambda n: (6, 18, 26)[n],
    ("bvx_morph_options", "neighbourhood"): lambda n: (6, 18, 26)[n],
    ("bvx_hollow_options", "drain_side"): lambda n: 1 << n,
    ("bvx_morph_options", "beyond"): lambda n: n - 1,
}

# Defaults other than 0 that no row of the library holds, and rows whose 0 stands for what no number says.
BY_HAND = {
    ("bvx_repair_options", "resolution"): "only where there is no lattice", ("bvx_boolean_options", "resolution"): "likewise",
    ("bvx_hull_options", "resolution"): "likewise", ("bvx_inspect_options", "resolution"): "likewise",
    ("bvx_levels_options", "resolution"): "from 256 to 320",
    ("bvx_repair_options", "samples"): "counts have no such row", ("bvx_lod_options", "threshold"): "both ends are excluded",
    ("bvx_read_volume_options", "spacing"): "an array", ("bvx_slice_options", "normal"): "an array", ("bvx_slice_options", "label"): "0 is BVX_LABEL_ZERO",
    ("bvx_render_options", "direction"): "an array", ("bvx_render_options", "up"): "an array", ("bvx_render_options", "colour"): "an array",
    ("bvx_render_options", "background"): "an array",
}
