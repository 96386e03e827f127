/* lattice_json.c - where a grid lies, as JSON beside a file whose format cannot say it.
 *
 * Numbers are printed to read back as they were. The reader takes keys in any order, passes over those it does
 * not know, and refuses what is missing, twice there or contradicts itself: center0 follows from origin, spacing
 * and window.low, and who changes one must change the other. */
#include "io/json.h"
#include "io_grid/grid_formats.h"

static void json_center0(const bvx_lattice *lattice, const int32_t low[3], double center[3])
{
    for (int a = 0; a < 3; a++) center[a] = lattice->origin[a] + ((double)low[a] + 0.5) * lattice->spacing[a];
}

static void json_put_lattice(const bvx_grid *grid, bvxi_output *out)
{
    double center[3];

    /* Derived from origin and spacing, for programs that want a centre; the reader checks that it agrees. */
    json_center0(&grid->lattice, grid->low, center);
    bvxi_output_print(out, "{\n  \"format\": \"bitvox lattice\",\n  \"version\": 1,\n  \"origin\": [%v],\n",
                      grid->lattice.origin, ", ");
    bvxi_output_print(out, "  \"spacing\": [%v],\n  \"dims\": [%w],\n  \"fraction_bits\": %u,\n",
                      grid->lattice.spacing, ", ", grid->lattice.dims, ", ",
                      (uint64_t)grid->lattice.fraction_bits);
    bvxi_output_print(out, "  \"window\": {\"low\": [%w], \"size\": [%w]},\n  \"center0\": [%v],\n",
                      grid->low, ", ", grid->size, ", ", center, ", ");
    bvxi_output_print(out, "  \"axes\": \"xyz\"\n}\n");
}

static bvx_status run_write_lattice(bvx_context *context, const bvx_grid *grid, bvx_buffer *file)
{
    static const char *const function = "bvx_write_lattice";
    bvxi_output out = {0};
    bvx_buffer made = {0};

    BVXI_TRY(bvxi_renew_buffer(context, function, file));
    BVXI_TRY(bvxi_grid_check(context, function, grid));
    BVXI_TRY(bvxi_check_written_corner(context, function, grid));

    json_put_lattice(grid, &out);
    BVXI_TRY(bvxi_make_buffer(context, out.size, "the lattice's file", &made));
    out.bytes = made.bytes;
    out.size = 0;
    json_put_lattice(grid, &out);
    *file = made;
    return BVX_OK;
}

bvx_status bvx_write_lattice(bvx_context *context, const bvx_grid *grid, bvx_buffer *file)
{
    return BVXI_CALL(context, run_write_lattice(context, grid, file));
}

typedef struct json_lattice {
    bvxi_source source; /* for messages */
    bvxi_json json;
    bvx_lattice lattice;
    bvx_window window;
    double center[3];
} json_lattice;

static BVXI_COLD bvx_status json_expected(const json_lattice *l, uint32_t value, const char *what)
{
    return bvxi_fail_expected(&l->source, l->json.text + l->json.value[value].at, what);
}

/* The value of a key, which an object must have once. */
static bvx_status json_find(const json_lattice *l, uint32_t object, const char *key, uint32_t *value)
{
    uint32_t i = object + 1;
    *value = BVXI_JSON_NONE;
    for (uint32_t left = bvxi_json_count(&l->json, object); left > 0; left--, i = l->json.value[i + 1].next) {
        if (!bvxi_json_is(&l->json, i, key)) continue;
        if (*value != BVXI_JSON_NONE) return json_expected(l, i, "each key once");
        *value = i + 1;
    }
    if (*value != BVXI_JSON_NONE) return BVX_OK;
    return bvxi_fail(l->source.ctx, BVX_ERR_FORMAT, "lattice: the key \"%s\" is missing", key);
}

/* A whole number that an int32_t holds, written in any way: 3.0 and 3e0 are whole numbers too. */
static bvx_status json_take_count(const json_lattice *l, uint32_t value, int32_t *count)
{
    double const v = bvxi_json_kind(&l->json, value) == BVXI_JSON_NUMBER ? bvxi_json_number(&l->json, value)
                                                                         : -1.0;
    if (!(v >= 0.0 && v <= 2147483647.0) || v != (double)(int32_t)v)
        return json_expected(l, value, "a whole number from 0 to 2147483647");
    *count = (int32_t)v;
    return BVX_OK;
}

static bvx_status json_take_three(const json_lattice *l, uint32_t object, const char *key, double *doubles,
                                  int32_t *counts)
{
    uint32_t array, i;
    BVXI_TRY(json_find(l, object, key, &array));
    if (bvxi_json_kind(&l->json, array) != BVXI_JSON_ARRAY || bvxi_json_count(&l->json, array) != 3)
        return json_expected(l, array, "three numbers between brackets");
    i = array + 1;
    for (int a = 0; a < 3; a++, i = l->json.value[i].next) {
        if (bvxi_json_kind(&l->json, i) != BVXI_JSON_NUMBER) return json_expected(l, i, "a number");
        if (counts != NULL) BVXI_TRY(json_take_count(l, i, &counts[a]));
        else doubles[a] = bvxi_json_number(&l->json, i);
    }
    return BVX_OK;
}

static bvx_status json_take_exact(const json_lattice *l, const char *key, const char *wanted,
                                  const char *what)
{
    uint32_t value;
    BVXI_TRY(json_find(l, 0, key, &value));
    return bvxi_json_is(&l->json, value, wanted) ? BVX_OK : json_expected(l, value, what);
}

static bvx_status json_take_lattice(json_lattice *l)
{
    uint32_t value;
    int32_t version = 0;

    if (bvxi_json_kind(&l->json, 0) != BVXI_JSON_OBJECT) return json_expected(l, 0, "'{'");
    BVXI_TRY(json_take_exact(l, "format", "bitvox lattice", "\"bitvox lattice\""));
    BVXI_TRY(json_find(l, 0, "version", &value));
    BVXI_TRY(json_take_count(l, value, &version));
    if (version != 1)
        return bvxi_fail(l->source.ctx, BVX_ERR_FORMAT, "lattice: version %d; version 1 is read",
                         (int64_t)version);
    BVXI_TRY(json_take_three(l, 0, "origin", l->lattice.origin, NULL));
    BVXI_TRY(json_take_three(l, 0, "spacing", l->lattice.spacing, NULL));
    BVXI_TRY(json_take_three(l, 0, "dims", NULL, l->lattice.dims));
    BVXI_TRY(json_find(l, 0, "fraction_bits", &value));
    BVXI_TRY(json_take_count(l, value, &l->lattice.fraction_bits));
    BVXI_TRY(json_find(l, 0, "window", &value));
    if (bvxi_json_kind(&l->json, value) != BVXI_JSON_OBJECT)
        return json_expected(l, value, "an object of low and size");
    BVXI_TRY(json_take_three(l, value, "low", NULL, l->window.low));
    BVXI_TRY(json_take_three(l, value, "size", NULL, l->window.size));
    BVXI_TRY(json_take_three(l, 0, "center0", l->center, NULL));
    return json_take_exact(l, "axes", "xyz", "\"xyz\", the one order of axes");
}

static bvx_status run_read_lattice(bvx_context *context, const void *bytes, uint64_t size, bvx_grid *grid)
{
    static const char *const function = "bvx_read_lattice";
    json_lattice l = {0};

    BVXI_TRY(bvxi_check_bytes(context, function, bytes, size));
    BVXI_TRY(bvxi_grid_check(context, function, grid));

    /* Values go to l first: the grid changes only when all of them fit each other. */
    l.source.ctx = context;
    l.source.format = "lattice";
    l.source.begin = bytes;
    l.source.end = l.source.begin + (size_t)size;
    const char *const text = bvxi_skip_mark(l.source.begin, l.source.end);
    BVXI_TRY(bvxi_json_read(&l.source, text, (uint64_t)(l.source.end - text), &l.json));
    BVXI_TRY(json_take_lattice(&l));

    /* The argument at fault is the file, whatever the check of lattices calls it. */
    if (bvxi_lattice_check(context, "lattice", &l.lattice) != BVX_OK) return BVX_ERR_FORMAT;
    for (int a = 0; a < 3; a++)
        if (l.window.size[a] != grid->size[a])
            return bvxi_fail(context, BVX_ERR_LATTICE,
                             "lattice: the window is %d voxels along %s, the grid %d",
                             (int64_t)l.window.size[a], bvxi_axis_name[a], (int64_t)grid->size[a]);
    if (bvx_grid_bound(&l.lattice, &l.window) == 0)
        return bvxi_fail(context, BVX_ERR_FORMAT, "lattice: the window is not inside the lattice");

    /* A thousandth of a voxel, and what a few roundings of another program may add. */
    double center[3];

    /* Computed as the writer did, so that a file of ours agrees to the last bit. */
    json_center0(&l.lattice, l.window.low, center);
    for (int a = 0; a < 3; a++) {
        double const off = center[a] - l.center[a], far = center[a] < 0 ? -center[a] : center[a];
        double const most = 1e-3 * l.lattice.spacing[a] + 1e-15 * far;
        if (!(off <= most && -off <= most))
            return bvxi_fail(context, BVX_ERR_FORMAT,
                             "lattice: center0 is %g along %s, but origin, spacing and window give %g",
                             l.center[a], bvxi_axis_name[a], center[a]);
    }
    grid->lattice = l.lattice;
    memcpy(grid->low, l.window.low, sizeof grid->low);
    return BVX_OK;
}

bvx_status bvx_read_lattice(bvx_context *context, const void *bytes, uint64_t size, bvx_grid *grid)
{
    return BVXI_CALL(context, run_read_lattice(context, bytes, size, grid));
}
