/* build_bodies.c - bvx_build_bodies: the bodies of several labels at once, with the same faces where two
 * touch.
 *
 * All contours become edges of one set of tetrahedra, as one body's do (oblique.c). Each tetrahedron is then
 * given to one body or to the outside (joint_cut.c), by numbers that all bodies share (joint_fields.c); a
 * body's surface is that of its tetrahedra (joint_surface.c). Parallel planes are taken the same way. */
#include "bodies/joint.h"

#include "mesh/mesh.h"

static const char bodies_name[] = "bvx_build_bodies";

static bvx_status check_labels(bvx_context *ctx, const int32_t *labels, uint32_t count)
{
    if (count == 0 || count > BVXI_JOINT_BODIES)
        return bvxi_fail_for(ctx, BVX_ERR_ARGUMENT, BVX_REASON_RANGE,
                             "%s: count is %u; 1 to %u bodies are possible", bodies_name, (uint64_t)count,
                             (uint64_t)BVXI_JOINT_BODIES);
    for (uint32_t i = 0; i < count; i++) {
        /* For one body it means the only label there is, which may be another of these. */
        if (labels[i] == BVX_LABEL_ZERO)
            return bvxi_fail_for(ctx, BVX_ERR_ARGUMENT, BVX_REASON_CHOICE,
                                 "%s: labels[%u] is BVX_LABEL_ZERO, which is no body's", bodies_name,
                                 (uint64_t)i);
        for (uint32_t j = 0; j < i; j++)
            if (labels[i] == labels[j])
                return bvxi_fail_for(ctx, BVX_ERR_ARGUMENT, BVX_REASON_CONTRADICTION,
                                     "%s: labels[%u] and labels[%u] are both %d", bodies_name, (uint64_t)j,
                                     (uint64_t)i, (int64_t)labels[i]);
    }
    return BVX_OK;
}

static bvx_status make_joint(bvxi_oblique *o, const int32_t *labels, uint32_t count, bvx_mesh *meshes)
{
    bvxi_joint_cut cut = {0};
    BVXI_TRY(BVXI_SHARE(o->ctx, 0.0, 0.4, bvxi_joint_open(o, labels, count)));
    BVXI_TRY(BVXI_SHARE(o->ctx, 0.4, 0.5, bvxi_oblique_lattice(o)));
    BVXI_TRY(BVXI_SHARE(o->ctx, 0.5, 0.55, bvxi_oblique_cells(o)));
    BVXI_TRY(BVXI_SHARE(o->ctx, 0.55, 0.6, bvxi_oblique_split_planes(o)));
    BVXI_TRY(BVXI_SHARE(o->ctx, 0.6, 0.7, bvxi_oblique_contours(o)));
    BVXI_TRY(BVXI_SHARE(o->ctx, 0.7, 0.85, bvxi_joint_cut_all(o, &cut)));
    return BVXI_SHARE(o->ctx, 0.85, 1.0, bvxi_joint_surfaces(o, &cut, meshes));
}

static bvx_status run_build_bodies(bvx_context *context, const bvx_sections *sections,
                                   const bvx_sections_options *options, const int32_t *labels, uint32_t count,
                                   bvx_mesh *meshes)
{
    bvxi_oblique o = {0};

    if (labels == NULL) return bvxi_fail_null(context, bodies_name, "labels");
    if (meshes == NULL) return bvxi_fail_null(context, bodies_name, "meshes");
    BVXI_TRY(check_labels(context, labels, count));

    o.ctx = context;
    o.function = bodies_name;
    BVXI_TRY(bvxi_take_options(context, bodies_name, options, &o.options, sizeof o.options));
    BVXI_TRY(bvxi_section_options_check(context, bodies_name, &o.options));
    if (o.options.caps == BVX_CAPS_OPEN)
        return bvxi_fail_for(context, BVX_ERR_ARGUMENT, BVX_REASON_CHOICE,
                             "%s: bodies with the same faces are closed: caps are flat or tapered",
                             bodies_name);
    BVXI_TRY(bvxi_sections_check(context, bodies_name, sections));
    BVXI_TRY(bvxi_sections_check_extent(context, bodies_name, sections));
    for (uint32_t i = 0; i < count; i++) BVXI_TRY(bvxi_mesh_check_reserved(context, bodies_name, &meshes[i]));

    bvx_sections with_normals = *sections;
    if (sections->normals == NULL)
        BVXI_TRY(BVXI_ARRAY(context, 3 * (sections->section_count + 1), "the sections' normals",
                            with_normals.normals));
    for (uint64_t i = 0; i < sections->section_count && sections->normals == NULL; i++)
        memcpy(with_normals.normals + 3 * i, sections->normal, 24);
    o.given = &with_normals;
    bvx_status const status = make_joint(&o, labels, count, meshes);
    if (status != BVX_OK) {
        for (uint32_t i = 0; i < count; i++) {
            if (meshes[i].owned) bvx_mesh_free(context, &meshes[i]);
            else meshes[i].vertex_count = meshes[i].triangle_count = 0;
        }
    }
    if (status != BVX_OK || o.options.report == NULL) return status;
    bvxi_sections_warn(context, &o.report, o.options.slabs.depth);
    *o.options.report = o.report;
    return BVX_OK;
}

bvx_status bvx_build_bodies(bvx_context *context, const bvx_sections *sections,
                            const bvx_sections_options *options, const int32_t *labels, uint32_t count,
                            bvx_mesh *meshes)
{
    return BVXI_CALL(context, run_build_bodies(context, sections, options, labels, count, meshes));
}
