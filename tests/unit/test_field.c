/* test_field.c - bvx_measure_field: values against every triangle in turn,
 * windows, types, what may not change the bytes, refusals. */
#include "field_support.h"

static void add_star(const bvx_lattice *l)
{
    double centre[3], radius[3];
    for (int a = 0; a < 3; a++) {
        double const side = l->dims[a] * l->spacing[a];
        centre[a] = l->origin[a] + maker_between(&seed, 0.35 * side, 0.65 * side, 4096);
        radius[a] = maker_between(&seed, 0.15 * side, 0.4 * side, 4096);
    }
    maker_star(&mesh, &seed, centre, radius, 0.4, 4 + maker_below(&seed, 4), 5 + maker_below(&seed, 5),
               65536);
}

/* ---- values ---- */

/* Band, order, distances, vectors and features are what all triangles say. */
static void assert_values(const bvx_field *f, double half_width)
{
    double const tiny = 1e-7, width = f->half_width;
    uint64_t n = 0;

    TEST_ASSERT_EQUAL_DOUBLE(half_width, width);
    for (int32_t z = 0; z < f->band.size[2]; z++)
        for (int32_t y = 0; y < f->band.size[1]; y++) {
            TEST_ASSERT_EQUAL_UINT64(n, f->row_values[z * f->band.size[1] + y]);
            for (int32_t x = 0; x < f->band.words_per_row * 64; x++) {
                int const valued = bvx_grid_get(&f->band, x, y, z);
                double c[3], v[3], q[3], want, d;
                uint32_t triangle = 0;
                if (x >= f->band.size[0]) {
                    TEST_ASSERT_EQUAL_INT(0, valued);
                    continue;
                }
                centre_of(&f->band, x, y, z, c);
                want = slow_distance(c, &triangle);
                if (fabs(want - width) > tiny) TEST_ASSERT_EQUAL_INT(want < width, valued);
                TEST_ASSERT_EQUAL_UINT64(valued ? n : UINT64_MAX, bvx_field_value(f, x, y, z));
                if (!valued) continue;
                for (uint64_t a = 0; a < 3; a++) {
                    v[a] = number_at(f, f->vectors, 3 * n + a);
                    q[a] = c[a] + v[a];
                }
                d = number_at(f, f->distances, n);
                TEST_ASSERT_TRUE(f->value_type != BVX_F64 || fabs(sqrt(dot3(v, v)) - fabs(d)) <= 1e-12);
                TEST_ASSERT_DOUBLE_WITHIN(f->value_type == BVX_F64 ? 1e-12 : 2e-6, want, fabs(d));
                TEST_ASSERT_TRUE(f->triangles[n] < mesh.triangles);
                TEST_ASSERT_DOUBLE_WITHIN(tiny, want, distance_to(f->triangles[n], c));
                /* needles: 2^-26 of an edge */
                TEST_ASSERT_TRUE(distance_to(f->triangles[n], q) <= (f->value_type == BVX_F64 ? tiny : 2e-6));
                TEST_ASSERT_TRUE(f->features[n] <= 6);
                if (f->features[n] >= 4) {
                    double t[3][3];
                    corners_of(f->triangles[n], t);
                    for (int a = 0; a < 3; a++)
                        TEST_ASSERT_DOUBLE_WITHIN(1e-5, t[f->features[n] - 4][a], q[a]);
                }
                n++;
            }
        }
    TEST_ASSERT_EQUAL_UINT64(n, f->value_count);
    TEST_ASSERT_EQUAL_UINT64(n, f->row_values[f->band.size[1] * f->band.size[2]]);
}

static void test_values_are_those_of_all_triangles(void)
{
    static const int32_t shapes[][3] = {{20, 18, 16}, {65, 7, 6}, {64, 5, 9},
                                        {1, 12, 12},  {9, 1, 30}, {130, 3, 3}};

    for (int s = 0; s < 6; s++)
        for (int type = BVX_F32; type <= BVX_F64; type++) {
            bvx_lattice const l = lattice_with(-3, 2, 0.25, 0.5, 0.75, 1, shapes[s][0], shapes[s][1],
                                               shapes[s][2]);
            bvx_field_options o = field_options(s == 0 ? 2.5 : 1.25, BVX_FILL_PARITY);
            bvx_field f;
            o.value_type = type;
            maker_clear(&mesh);
            add_star(&l);
            f = field_by(ctx, &l, &o);
            TEST_ASSERT_EQUAL_INT32(type, f.value_type);
            assert_values(&f, o.half_width);
            TEST_ASSERT_TRUE(f.value_count > 0);
            bvx_field_free(ctx, &f);
        }
}

static void test_soups_needles_and_triangles_without_area(void)
{
    static const double low[3] = {-4, -4, -4}, high[3] = {20, 20, 20};

    for (int trial = 0; trial < (quick ? 2 : 8); trial++) {
        bvx_lattice const l = lattice_with(0, 0, 0, 1, 1, 1, 17, 12, 9);
        bvx_field_options o = field_options(trial & 1 ? 1.5 : HUGE_VAL, BVX_FILL_NONE);
        bvx_field f;
        o.value_type = BVX_F64;
        maker_clear(&mesh);
        maker_soup(&mesh, &seed, 5, low, high, 65536);
        maker_needles(&mesh, &seed, 3, low, high, 65536);
        maker_degenerate(&mesh, &seed, 3, low, high, 65536);
        f = field_by(ctx, &l, &o);
        TEST_ASSERT_NULL(f.inside.words);
        assert_values(&f, o.half_width);
        bvx_field_free(ctx, &f);
    }
}

static void test_the_least_triangle_wins_a_tie(void)
{
    bvx_lattice const l = lattice_with(0, 0, 0, 1, 1, 1, 8, 8, 8);
    double const low[3] = {2, 2, 2}, high[3] = {6, 6, 6};
    bvx_field f;

    maker_box(&mesh, low, high);
    for (size_t i = 0; i < 12; i++) maker_duplicate(&mesh, i);
    f = field_of(&l, 2, BVX_FILL_NONE);
    for (uint64_t i = 0; i < f.value_count; i++) TEST_ASSERT_TRUE(f.triangles[i] < 12);
    bvx_field_free(ctx, &f);
}

static void test_box_by_hand(void)
{
    bvx_lattice const l = lattice_with(0, 0, 0, 1, 1, 1, 70, 5, 5);
    double const low[3] = {60, 1, 1}, high[3] = {68, 4, 4};
    bvx_field_options o = {.struct_size = sizeof o};
    bvx_field f;
    const float *d, *v;

    maker_box(&mesh, low, high);
    o.half_width = 1;
    f = field_by(ctx, &l, &o);
    TEST_ASSERT_EQUAL_INT32(BVX_FILL_PARITY, f.sign); /* it is closed and oriented */
    TEST_ASSERT_NULL(f.triangles);
    TEST_ASSERT_NULL(f.features);
    d = f.distances;
    v = f.vectors;
    TEST_ASSERT_EQUAL_UINT64(UINT64_MAX, bvx_field_value(&f, 58, 2, 2)); /* 1.5 before the face x = 60 */
    TEST_ASSERT_TRUE(bvx_field_value(&f, 60, 2, 2) < f.value_count);
    /* a struct that is not what the words are; two words a row are right */
    for (int32_t n = -1; n < 4; n++) {
        bvx_field wrong = f;
        if (n < 2) wrong.band.words_per_row = n;
        else if (n == 2) wrong.band.size[0] += 64;
        else wrong.band.word_capacity = 0;
        TEST_ASSERT_EQUAL_UINT64(UINT64_MAX, bvx_field_value(&wrong, 60, 2, 2));
    }
    uint64_t n = bvx_field_value(&f, 59, 2, 2);
    TEST_ASSERT_EQUAL_FLOAT(0.5f, d[n]);
    TEST_ASSERT_EQUAL_FLOAT(0.5f, v[3 * n]);
    TEST_ASSERT_EQUAL_FLOAT(0.0f, v[3 * n + 1]);
    n = bvx_field_value(&f, 60, 2, 2);
    TEST_ASSERT_EQUAL_FLOAT(-0.5f, d[n]);
    TEST_ASSERT_EQUAL_FLOAT(-0.5f, v[3 * n]);
    n = bvx_field_value(&f, 68, 4, 4); /* beyond a corner */
    TEST_ASSERT_EQUAL_FLOAT((float)sqrt(0.75), d[n]);
    TEST_ASSERT_EQUAL_FLOAT(-0.5f, v[3 * n + 2]);
    TEST_ASSERT_EQUAL_UINT64(UINT64_MAX, bvx_field_value(&f, 63, 2, 2)); /* 1.5 from the walls y and z */
    TEST_ASSERT_EQUAL_INT(1, bvx_grid_get(&f.inside, 63, 2, 2));         /* inside all the same */
    TEST_ASSERT_EQUAL_UINT64(72, set_in(&f.inside));
    TEST_ASSERT_EQUAL_UINT64(UINT64_MAX, bvx_field_value(&f, -1, 0, 0));
    TEST_ASSERT_EQUAL_UINT64(UINT64_MAX, bvx_field_value(&f, 70, 0, 0));
    TEST_ASSERT_EQUAL_UINT64(UINT64_MAX, bvx_field_value(&f, 0, 5, 0));
    TEST_ASSERT_EQUAL_UINT64(UINT64_MAX, bvx_field_value(&f, 0, 0, 5));
    TEST_ASSERT_EQUAL_UINT64(UINT64_MAX, bvx_field_value(NULL, 0, 0, 0));
    bvx_field_free(ctx, &f);
    TEST_ASSERT_EQUAL_UINT64(UINT64_MAX, bvx_field_value(&f, 59, 2, 2));
}

static void test_options_choose_the_arrays(void)
{
    bvx_lattice const l = lattice_with(0, 0, 0, 1, 1, 1, 12, 12, 12);

    for (int32_t sign = BVX_FILL_PARITY; sign <= BVX_FILL_NONE; sign++)
        if (BVX_FILLS_OF_FIELD >> sign & 1)
            for (int choice = 0; choice < 4; choice++) {
                bvx_field_options o = field_options(2, sign);
                bvx_field f, all;
                maker_clear(&mesh);
                add_star(&l);
                all = field_by(ctx, &l, &o);
                o.no_vectors = choice & 1;
                o.features = choice >> 1;
                f = field_by(ctx, &l, &o);
                TEST_ASSERT_EQUAL_INT(o.no_vectors, f.vectors == NULL);
                TEST_ASSERT_EQUAL_INT(o.features, f.triangles != NULL);
                TEST_ASSERT_EQUAL_INT(o.features, f.features != NULL);
                TEST_ASSERT_EQUAL_INT32(sign, f.sign);
                TEST_ASSERT_TRUE(same_bits(&all.band, &f.band));
                TEST_ASSERT_EQUAL_MEMORY(all.distances, f.distances, (size_t)f.value_count * 4);
                bvx_field_free(ctx, &f);
                bvx_field_free(ctx, &all);
            }
}

static void test_floats_are_the_doubles_rounded(void)
{
    bvx_lattice const l = lattice_with(0, 0, 0, 1, 0.5, 2, 14, 20, 8);
    bvx_field_options o = field_options(3, BVX_FILL_PARITY);
    bvx_field f, d;

    add_star(&l);
    f = field_by(ctx, &l, &o);
    o.value_type = BVX_F64;
    d = field_by(ctx, &l, &o);
    TEST_ASSERT_EQUAL_UINT64(d.value_count, f.value_count);
    TEST_ASSERT_EQUAL_DOUBLE(6.0, f.half_width);
    for (uint64_t i = 0; i < f.value_count; i++) {
        TEST_ASSERT_EQUAL_FLOAT((float)((double *)d.distances)[i], ((float *)f.distances)[i]);
        for (uint64_t a = 3 * i; a < 3 * i + 3; a++)
            TEST_ASSERT_EQUAL_FLOAT((float)((double *)d.vectors)[a], ((float *)f.vectors)[a]);
    }
    TEST_ASSERT_EQUAL_MEMORY(d.triangles, f.triangles, (size_t)f.value_count * 4);
    TEST_ASSERT_TRUE(same_bits(&d.inside, &f.inside));
    bvx_field_free(ctx, &f);
    bvx_field_free(ctx, &d);
}

static void test_all_centres(void)
{
    bvx_lattice const l = lattice_with(0, 0, 0, 1, 1, 1, 67, 9, 8);
    bvx_field f;

    add_star(&l);
    f = field_of(&l, HUGE_VAL, BVX_FILL_PARITY);
    TEST_ASSERT_EQUAL_UINT64(67 * 9 * 8, f.value_count);
    TEST_ASSERT_EQUAL_UINT64(67 * 9 * 8, set_in(&f.band));
    assert_values(&f, HUGE_VAL);
    bvx_field_free(ctx, &f);
    f = field_of(&l, 1e300, BVX_FILL_NORMAL); /* finite, and no centre is beyond */
    TEST_ASSERT_EQUAL_UINT64(67 * 9 * 8, f.value_count);
    bvx_field_free(ctx, &f);
}

/* ---- windows ---- */

static void assert_window_of(const bvx_field *whole, const bvx_field *part)
{
    const int32_t *const low = part->band.low, *const size = part->band.size;

    for (int32_t z = 0; z < size[2]; z++)
        for (int32_t y = 0; y < size[1]; y++)
            for (int32_t x = 0; x < part->band.words_per_row * 64; x++) {
                uint64_t n, w;
                if (x >= size[0]) {
                    TEST_ASSERT_EQUAL_INT(0, bvx_grid_get(&part->inside, x, y, z));
                    continue;
                }
                TEST_ASSERT_EQUAL_INT(bvx_grid_get(&whole->band, low[0] + x, low[1] + y, low[2] + z),
                                      bvx_grid_get(&part->band, x, y, z));
                TEST_ASSERT_EQUAL_INT(bvx_grid_get(&whole->inside, low[0] + x, low[1] + y, low[2] + z),
                                      bvx_grid_get(&part->inside, x, y, z));
                n = bvx_field_value(part, x, y, z);
                w = bvx_field_value(whole, low[0] + x, low[1] + y, low[2] + z);
                TEST_ASSERT_EQUAL_INT(w == UINT64_MAX, n == UINT64_MAX);
                if (n == UINT64_MAX) continue;
                TEST_ASSERT_EQUAL_MEMORY((float *)whole->distances + w, (float *)part->distances + n, 4);
                TEST_ASSERT_EQUAL_MEMORY((float *)whole->vectors + 3 * w, (float *)part->vectors + 3 * n, 12);
                TEST_ASSERT_EQUAL_UINT32(whole->triangles[w], part->triangles[n]);
                TEST_ASSERT_EQUAL_UINT8(whole->features[w], part->features[n]);
            }
}

static void test_windows_are_cut_out_of_the_whole(void)
{
    for (int trial = 0; trial < (quick ? 2 : 6); trial++) {
        bvx_lattice const l = lattice_with(1, 2, 3, 0.5, 1, 0.75, 150, 16, 18);
        maker_clear(&mesh);
        add_star(&l);
        add_star(&l);
        for (int i = 0; i < trial; i++)
            maker_remove(&mesh, (size_t)maker_below(&seed, (int32_t)mesh.triangles));
        for (int32_t sign = BVX_FILL_AUTO; sign < BVX_FILL_NONE; sign++)
            if (BVX_FILLS_OF_FIELD >> sign & 1) {
                bvx_field_options o = field_options(1.5, sign);
                bvx_field whole;
                whole = field_by(ctx, &l, &o);
                for (int i = 0; i < 4; i++) {
                    bvx_field part;
                    for (int a = 0; a < 3; a++) {
                        o.window.low[a] = maker_below(&seed, l.dims[a]);
                        o.window.size[a] = 1 + maker_below(&seed, l.dims[a] - o.window.low[a]);
                    }
                    part = field_by(ctx, &l, &o);
                    TEST_ASSERT_EQUAL_MEMORY(o.window.low, part.inside.low, sizeof part.inside.low);
                    assert_window_of(&whole, &part);
                    bvx_field_free(ctx, &part);
                }
                bvx_field_free(ctx, &whole);
            }
    }
}

/* ---- what may not change the bytes ---- */

static void assert_same_field(const bvx_field *a, const bvx_field *b)
{
    TEST_ASSERT_TRUE(same_bits(&a->band, &b->band));
    TEST_ASSERT_TRUE(same_bits(&a->inside, &b->inside));
    TEST_ASSERT_EQUAL_UINT64(a->value_count, b->value_count);
    TEST_ASSERT_EQUAL_INT(0, memcmp(a->vectors, b->vectors, (size_t)a->value_count * 12));
    TEST_ASSERT_EQUAL_INT(0, memcmp(a->distances, b->distances, (size_t)a->value_count * 4));
    TEST_ASSERT_EQUAL_INT(0, memcmp(a->triangles, b->triangles, (size_t)a->value_count * 4));
    TEST_ASSERT_EQUAL_INT(0, memcmp(a->features, b->features, (size_t)a->value_count));
}

static void test_threads_and_code_paths_change_nothing(void)
{
    static const int32_t ways[][2] = {
        {1, BVX_CPU_PORTABLE}, {2, BVX_CPU_BEST}, {8, BVX_CPU_BEST}, {8, BVX_CPU_PORTABLE}};
    bvx_lattice const l = lattice_with(0, 0, 0, 1, 1, 0.5, 70, 60, 90);

    add_star(&l);
    add_star(&l);
    for (int holes = 0; holes < 2; holes++) {
        for (int i = 0; i < 5 * holes; i++)
            maker_remove(&mesh, (size_t)maker_below(&seed, (int32_t)mesh.triangles));
        for (int32_t sign = BVX_FILL_PARITY; sign < BVX_FILL_NONE; sign++)
            if (BVX_FILLS_OF_FIELD >> sign & 1) {
                bvx_field_options const o = field_options(2, sign);
                bvx_field one;
                one = field_by(ctx, &l, &o);
                for (int w = 0; w < 4; w++) {
                    bvx_context *const other = suite_context(ways[w][0], ways[w][1]);
                    bvx_field f = field_by(other, &l, &o);
                    assert_same_field(&one, &f);
                    bvx_field_free(other, &f);
                    TEST_ASSERT_EQUAL_UINT64(0, bvx_memory_used(other));
                    bvx_context_destroy(other);
                }
                bvx_field_free(ctx, &one);
            }
    }
}

static void test_views_of_any_type_change_nothing(void)
{
    bvx_lattice const l = lattice_with(0, 0, 0, 1, 1, 1, 24, 22, 20);
    bvx_field_options const o = field_options(2, BVX_FILL_NORMAL);
    bvx_mesh_view view;
    uint64_t *indices;
    unsigned char *positions;
    bvx_field a, b = {0};

    add_star(&l);
    a = field_by(ctx, &l, &o);
    view = maker_view(&mesh);
    indices = malloc(mesh.triangles * 3 * 8);
    positions = malloc(mesh.vertices * 40 + 1);
    for (size_t i = 0; i < 3 * mesh.triangles; i++) indices[i] = mesh.t[i];
    for (size_t i = 0; i < mesh.vertices; i++) memcpy(positions + 1 + 40 * i, mesh.p + 3 * i, 24);
    view.positions = positions + 1; /* not aligned */
    view.position_stride = 40;
    view.indices = indices;
    view.index_type = BVX_U64;
    view.index_stride = 0;
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_measure_field(ctx, &view, &l, &o, &b));
    assert_same_field(&a, &b);
    bvx_field_free(ctx, &a);
    bvx_field_free(ctx, &b);
    free(indices);
    free(positions);
}

/* ---- refusals ---- */

static bvx_status refused(bvx_context *c, const bvx_mesh_view *view, const bvx_lattice *l,
                          const bvx_field_options *o, const char *word)
{
    static const bvx_field empty = {0};
    bvx_field f = {0};
    uint64_t const held = bvx_memory_used(c);
    bvx_status const status = bvx_measure_field(c, view, l, o, &f);

    TEST_ASSERT_NOT_EQUAL(BVX_OK, status);
    TEST_ASSERT_EQUAL_MEMORY(&empty, &f, sizeof f);
    TEST_ASSERT_EQUAL_UINT64(held, bvx_memory_used(c));
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(bvx_last_message(c), word), bvx_last_message(c));
    return status;
}

static void test_options_out_of_range(void)
{
    bvx_lattice l = lattice_with(0, 0, 0, 1, 1, 1, 12, 12, 12), bad;
    bvx_mesh_view view;
    bvx_field_options o = field_options(2, BVX_FILL_PARITY);
    bvx_field_options const good = o;
    bvx_field f = {0};

    add_star(&l);
    view = maker_view(&mesh);
#define REFUSED(change, status, word)                                       \
    do {                                                                    \
        o = good;                                                           \
        change;                                                             \
        TEST_ASSERT_EQUAL_INT32(status, refused(ctx, &view, &l, &o, word)); \
    } while (0)
    REFUSED(o.half_width = -1, BVX_ERR_ARGUMENT, "half_width is -1");
    REFUSED(o.half_width = -1, BVX_ERR_ARGUMENT, "half_width");
    REFUSED(o.half_width = (double)NAN, BVX_ERR_ARGUMENT, "half_width");
    REFUSED(o.sign = -1, BVX_ERR_ARGUMENT, "sign -1");
    REFUSED(o.sign = BVX_FILL_FLOOD, BVX_ERR_ARGUMENT, "sign 4");
    REFUSED(o.sign = BVX_FILL_COUNT, BVX_ERR_ARGUMENT, "sign 10");
    REFUSED(o.value_type = -1, BVX_ERR_ARGUMENT, "value_type -1");
    REFUSED(o.value_type = 3, BVX_ERR_ARGUMENT, "value_type 3");
    REFUSED(o.no_vectors = 2, BVX_ERR_ARGUMENT, "no_vectors is 2");
    REFUSED(o.features = -1, BVX_ERR_ARGUMENT, "features is -1");
    REFUSED(o.reserved[1] = 1, BVX_ERR_ARGUMENT, "reserved[1]");
    REFUSED(o.window.size[0] = 3, BVX_ERR_RANGE, "window");
    REFUSED((o.window.low[2] = 10, o.window.size[0] = o.window.size[1] = o.window.size[2] = 3), BVX_ERR_RANGE,
            "window");
    REFUSED(o.struct_size = 1, BVX_ERR_ARGUMENT, "struct_size of the options is 1");
#undef REFUSED
    o = good;
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_measure_field(NULL, &view, &l, &o, &f));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_measure_field(ctx, &view, &l, &o, NULL));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, refused(ctx, NULL, &l, &o, "mesh"));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, refused(ctx, &view, NULL, &o, "lattice"));
    bad = l;
    bad.dims[1] = 0;
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_RANGE, refused(ctx, &view, &bad, &o, "0 voxels along y"));
    bad = l;
    bad.spacing[1] = 1e-40;
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_RANGE, refused(ctx, &view, &bad, &o, "BVX_F64"));
    bad = l;
    bad.origin[0] = 0x1.fffffffffffffp1023;
    bad.spacing[0] = 1e299;
    o.value_type = BVX_F64;
    o.half_width = 1;
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_RANGE, refused(ctx, &view, &bad, &o, "no finite place along x"));
    o = good;
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_measure_field(ctx, &view, &l, &o, &f));
    f.band.owned = 0;
    /* as if it were the caller's */
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_measure_field(ctx, &view, &l, &o, &f));
    TEST_ASSERT_TRUE(f.value_count > 0);
    f.band.owned = 1;
    bvx_field_free(ctx, &f);
    bvx_field_free(ctx, &f);
    bvx_field_free(ctx, NULL);
}

static void test_meshes_that_cannot_be_measured(void)
{
    bvx_lattice const l = lattice_with(0, 0, 0, 1, 1, 1, 8, 8, 8);
    static const double low[3] = {1, 1, 1}, high[3] = {6, 6, 6};

    for (int32_t sign = BVX_FILL_AUTO; sign <= BVX_FILL_NONE; sign++)
        if (BVX_FILLS_OF_FIELD >> sign & 1) {
            bvx_field_options o = field_options(2, sign);
            bvx_mesh_view view;
            maker_clear(&mesh);
            view = maker_view(&mesh);
            TEST_ASSERT_EQUAL_INT32(BVX_ERR_EMPTY, refused(ctx, &view, &l, &o, "no triangle"));
            maker_degenerate(&mesh, &seed, 3, low, high, 16); /* a point and two segments */
            view = maker_view(&mesh);
            TEST_ASSERT_EQUAL_INT32(BVX_ERR_EMPTY, refused(ctx, &view, &l, &o, "area"));
            maker_box(&mesh, low, high);
            view = maker_view(&mesh);
            mesh.p[4] = (double)NAN;
            TEST_ASSERT_EQUAL_INT32(BVX_ERR_RANGE, refused(ctx, &view, &l, &o, "vertex 1 has y"));
            mesh.p[4] = HUGE_VAL;
            TEST_ASSERT_EQUAL_INT32(BVX_ERR_RANGE, refused(ctx, &view, &l, &o, "vertex 1 has y"));
            mesh.p[4] = 2;
            mesh.t[3 * mesh.triangles - 2] = (uint32_t)mesh.vertices;
            TEST_ASSERT_EQUAL_INT32(BVX_ERR_RANGE, refused(ctx, &view, &l, &o, "vertex index"));
            mesh.t[3 * mesh.triangles - 2] = 0;
            o.half_width = HUGE_VAL;
            mesh.p[1] = 1e39;
            TEST_ASSERT_EQUAL_INT32(
                BVX_ERR_RANGE, refused(ctx, &view, &l, &o, "do not fit the field's numbers: take BVX_F64"));
        }
}

static void test_memory_limit_is_kept(void)
{
    bvx_lattice const l = lattice_with(0, 0, 0, 1, 1, 1, 40, 40, 40);
    bvx_field_options const o = field_options(HUGE_VAL, BVX_FILL_PARITY);
    bvx_context_options c = {.struct_size = sizeof c};
    bvx_context *small = NULL;
    bvx_mesh_view view;

    add_star(&l);
    view = maker_view(&mesh);
    c.memory_limit = 1 << 18;
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_context_create(&c, &small));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_BUDGET, refused(small, &view, &l, &o, "limit"));
    TEST_ASSERT_EQUAL_UINT64(0, bvx_memory_used(small));
    bvx_context_destroy(small);
}

static void test_older_callers_keep_defaults(void)
{
    bvx_lattice const l = lattice_with(0, 0, 0, 1, 1, 1, 12, 12, 12);
    bvx_field_options o = field_options(1, BVX_FILL_VOTE);
    bvx_field f, plain;

    o.struct_size = offsetof(bvx_field_options, sign);
    add_star(&l);
    f = field_by(ctx, &l, &o);
    TEST_ASSERT_EQUAL_INT32(BVX_FILL_PARITY, f.sign);
    TEST_ASSERT_EQUAL_DOUBLE(1, f.half_width);
    TEST_ASSERT_NULL(f.features);
    bvx_field_free(ctx, &f);
    plain = field_by(ctx, &l, NULL);
    TEST_ASSERT_EQUAL_DOUBLE(3, plain.half_width);
    TEST_ASSERT_EQUAL_INT32(BVX_F32, plain.value_type);
    TEST_ASSERT_NOT_NULL(plain.vectors);
    bvx_field_free(ctx, &plain);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_values_are_those_of_all_triangles);
    RUN_TEST(test_soups_needles_and_triangles_without_area);
    RUN_TEST(test_the_least_triangle_wins_a_tie);
    RUN_TEST(test_box_by_hand);
    RUN_TEST(test_options_choose_the_arrays);
    RUN_TEST(test_floats_are_the_doubles_rounded);
    RUN_TEST(test_all_centres);
    RUN_TEST(test_windows_are_cut_out_of_the_whole);
    RUN_TEST(test_threads_and_code_paths_change_nothing);
    RUN_TEST(test_views_of_any_type_change_nothing);
    RUN_TEST(test_options_out_of_range);
    RUN_TEST(test_meshes_that_cannot_be_measured);
    RUN_TEST(test_memory_limit_is_kept);
    RUN_TEST(test_older_callers_keep_defaults);
    return UNITY_END();
}
