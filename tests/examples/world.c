/* world.c - for a world of voxels in chunks: bodies put in and dug out, and only the chunks meshed anew that changed.
 *
 *     world [VOXELS] [MESH.ply]
 *
 * Eight copies of a mesh stand in a world of so many voxels a side [256]. Chunks are cut out with a voxel of each
 * neighbour, so there is no wall between them, and their faces together are those of the whole. */
#include <bitvox_io.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

enum { CHUNK = 32, BODIES = 8 };

static bvx_context *ctx;

static void must(bvx_status status, const char *what)
{
    if (status == BVX_OK) return;
    fprintf(stderr, "world: %s: %s\n", what, bvx_last_message(ctx));
    exit(1);
}

static double milliseconds(clock_t from)
{
    return 1e3 * (double)(clock() - from) / CLOCKS_PER_SEC;
}

static bvx_mesh load(const char *path)
{
    bvx_mesh mesh = {0};
    FILE *const f = fopen(path, "rb");
    char *const bytes = malloc(1 << 26);

    if (f == NULL || bytes == NULL) {
        fprintf(stderr, "world: cannot read %s\n", path);
        exit(1);
    }
    must(bvx_read_mesh(ctx, bytes, fread(bytes, 1, 1 << 26, f), BVX_FORMAT_PLY, NULL, &mesh), path);
    fclose(f);
    free(bytes);
    return mesh;
}

/* One body on the world's lattice: a copy of the mesh in one of eight corners, or beside it. */
static bvx_grid body_at(const bvx_mesh *mesh, const bvx_lattice *world, const double corner[3])
{
    bvx_mesh_view view;
    bvx_lattice own;
    double transform[16] = {0}, longest = 0;
    double const size = 0.45 * world->dims[0];
    bvx_grid grid = {0};

    bvx_mesh_view_of(mesh, &view);
    must(bvx_lattice_fit(ctx, &view, 1024, &own), "the mesh's box");
    for (int a = 0; a < 3; a++) longest = own.dims[a] > longest ? own.dims[a] : longest;
    double const scale = size / (longest * own.spacing[0]);
    for (int a = 0; a < 3; a++) {
        transform[5 * a] = scale;
        transform[4 * a + 3] = (0.02 + corner[a]) * world->dims[0] - scale * own.origin[a];
    }
    transform[15] = 1;
    view.transform = transform;
    must(bvx_voxelize_solid(ctx, &view, world, NULL, &grid), "a solid");
    return grid;
}

/* The faces of a chunk; what it shows of its neighbours is theirs. Results that are passed again keep their memory. */
static uint64_t mesh_chunk(const bvx_grid *world, const int32_t chunk[3], bvx_grid *grid, bvx_mesh *mesh)
{
    bvx_faces_options o = {.struct_size = sizeof o};
    bvx_window window;

    for (int a = 0; a < 3; a++) {
        int32_t const begin = chunk[a] * CHUNK, end = begin + CHUNK, size = world->size[a];

        o.open_sides |= (begin > 0) << 2 * a | (end < size) << (2 * a + 1);
        window.low[a] = begin - (begin > 0);
        window.size[a] = (end < size ? end + 1 : size) - window.low[a];
    }
    must(bvx_grid_crop(ctx, world, &window, grid), "a chunk");
    must(bvx_extract_faces(ctx, grid, &o, mesh), "its faces");
    return mesh->triangle_count; /* an engine takes the mesh here */
}

/* The chunks that a mask has a voxel in, or one beside it; their triangles to *sum. */
static int mesh_chunks(const bvx_grid *world, const bvx_grid *mask, uint64_t *sum)
{
    static const int32_t factor[3] = {CHUNK, CHUNK, CHUNK};
    bvx_morph_options const o = {.struct_size = sizeof o, .neighbourhood = 6};
    bvx_grid near = {0}, chunks = {0}, grid = {0};
    bvx_mesh mesh = {0};
    int32_t at[3];
    int count = 0;

    must(bvx_grid_morph(ctx, mask, BVX_MORPH_DILATE, &o, &near), "what is beside");
    must(bvx_grid_downsample(ctx, &near, factor, BVX_REDUCE_ANY, &chunks), "chunks");
    for (at[2] = 0; at[2] < chunks.size[2]; at[2]++)
        for (at[1] = 0; at[1] < chunks.size[1]; at[1]++)
            for (at[0] = 0; at[0] < chunks.size[0]; at[0]++) {
                if (!bvx_grid_get(&chunks, at[0], at[1], at[2])) continue;
                *sum += mesh_chunk(world, at, &grid, &mesh);
                count++;
            }
    bvx_grid_free(ctx, &near);
    bvx_grid_free(ctx, &chunks);
    bvx_grid_free(ctx, &grid);
    bvx_mesh_free(ctx, &mesh);
    return count;
}

static void cast(const bvx_rays *caster, const double ray[6], double t_max)
{
    bvx_ray_hit hit;

    must(bvx_rays_cast(ctx, caster, ray, 1, t_max, &hit), "a ray");
    if (hit.hit) printf("ray: voxel %d %d %d\n", (int)hit.voxel[0], (int)hit.voxel[1], (int)hit.voxel[2]);
    else printf("ray: meets nothing\n");
}

int main(int argc, char **argv)
{
    int32_t const n = argc > 1 ? atoi(argv[1]) : 256, dims[3] = {n, n, n};
    double const origin[3] = {0, 0, 0}, spacing[3] = {1, 1, 1}, place[3] = {0.1, 0.05, 0.02};
    bvx_context_options const o = {.struct_size = sizeof o, .threads = 1};
    bvx_lattice lattice;
    bvx_grid world = {0}, before = {0};
    bvx_mesh faces = {0};
    uint64_t triangles = 0, anew = 0;

    must(bvx_context_create(&o, &ctx), "context");
    must(bvx_lattice_make(ctx, origin, spacing, dims, &lattice), "lattice");
    bvx_mesh mesh = load(argc > 2 ? argv[2] : "fixtures/knot.ply");
    for (int i = 0; i < BODIES; i++) {
        double const corner[3] = {0.5 * (i & 1), 0.5 * (i >> 1 & 1), 0.5 * (i >> 2)};
        bvx_grid body = body_at(&mesh, &lattice, corner);

        if (i == 0) {
            world = body;
            continue;
        }
        must(bvx_grid_combine(ctx, &world, &body, BVX_BOOLEAN_UNION, &world), "union");
        bvx_grid_free(ctx, &body);
    }

    clock_t start = clock();
    must(bvx_extract_faces(ctx, &world, NULL, &faces), "all faces");
    double const at_once = milliseconds(start);
    start = clock();
    int const chunks = mesh_chunks(&world, &world, &triangles);
    printf("world: %d^3 voxels, %llu triangles in %.1f ms; %d chunks in %.1f ms\n", (int)n,
           (unsigned long long)faces.triangle_count, at_once, chunks, milliseconds(start));
    if (triangles != faces.triangle_count) return 1;

    /* A ray now, and one when the world has changed: the handle is told where. */
    double const ray[6] = {0.3 * n, 0.2 * n, -1.0 * n, 0, 0, 1};
    bvx_rays *caster;
    must(bvx_rays_create(ctx, &world, &caster), "rays");
    cast(caster, ray, 4.0 * n);

    /* A body is dug out: what changed is the difference, and its chunks are meshed anew. */
    must(bvx_grid_crop(ctx, &world, NULL, &before), "a copy");
    bvx_grid hole = body_at(&mesh, &lattice, place);
    must(bvx_grid_combine(ctx, &world, &hole, BVX_BOOLEAN_DIFFERENCE, &world), "difference");
    must(bvx_grid_combine(ctx, &before, &world, BVX_BOOLEAN_XOR, &before), "what changed");
    int const changed = mesh_chunks(&world, &before, &anew);
    printf("edit: %d of %d chunks meshed anew, %llu triangles\n", changed, chunks, (unsigned long long)anew);

    bvx_window dug;
    for (int a = 0; a < 3; a++) {
        dug.low[a] = (int32_t)(place[a] * n);
        dug.size[a] = n / 2 + 2;
    }
    must(bvx_rays_update(ctx, caster, &world, &dug), "rays of what changed");
    cast(caster, ray, 4.0 * n);

    bvx_rays_free(ctx, caster);
    bvx_mesh_free(ctx, &faces);
    bvx_mesh_free(ctx, &mesh);
    bvx_grid_free(ctx, &world);
    bvx_grid_free(ctx, &before);
    bvx_grid_free(ctx, &hole);
    bvx_context_destroy(ctx);
    return 0;
}
