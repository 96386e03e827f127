/* test_read_ply.c - PLY files right and wrong, in the three encodings. */
#include "read_support.h"

enum { PLY = BVX_FORMAT_PLY };
enum { ASCII = 0, LITTLE = 1, BIG = 2 };

static uint8_t file[1 << 20];
static size_t file_size;
static int encoding;

static const char *const encodings[3] = {"ascii", "binary_little_endian", "binary_big_endian"};
static const char *const types[8][2] = {{"char", "int8"},     {"uchar", "uint8"},   {"short", "int16"},
                                        {"ushort", "uint16"}, {"int", "int32"},     {"uint", "uint32"},
                                        {"float", "float32"}, {"double", "float64"}};
static const int type_sizes[8] = {1, 1, 2, 2, 4, 4, 4, 8};
enum { I8, U8, I16, U16, I32, U32, F32, F64 };

static void put_text(const char *text)
{
    size_t const n = strlen(text);
    memcpy(file + file_size, text, n);
    file_size += n;
}

static void begin_header(int how)
{
    encoding = how;
    file_size = 0;
    put_text("ply\nformat ");
    put_text(encodings[how]);
    put_text(" 1.0\n");
}

/* A value of a type in the file's encoding. */
static void put_value(int type, double v)
{
    uint8_t bytes[8];
    uint64_t bits = type < F32 ? (uint64_t)(int64_t)v : 0;

    if (encoding == ASCII) {
        char text[40];
        sprintf(text, type < F32 ? "%.0f " : "%.17g ", v);
        put_text(text);
        return;
    }
    if (type == F64) memcpy(&bits, &v, sizeof bits);
    if (type == F32) {
        float const f = (float)v;
        uint32_t b;
        memcpy(&b, &f, sizeof b);
        bits = b;
    }
    for (int i = 0; i < type_sizes[type]; i++)
        bytes[encoding == BIG ? type_sizes[type] - 1 - i : i] = (uint8_t)(bits >> 8 * i & 0xff);
    memcpy(file + file_size, bytes, (size_t)type_sizes[type]);
    file_size += (size_t)type_sizes[type];
}

static void end_row(void)
{
    if (encoding == ASCII) file[file_size - 1] = '\n';
}

/* A square of four vertices and one face of four corners with the commonest header. */
static void put_square(int how, const char *vertex_count, const char *face_count)
{
    static const int xy[4][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    char header[400];

    begin_header(how);
    sprintf(header,
            "comment a square\nelement vertex %s\nproperty float x\nproperty float y\nproperty float z\n"
            "element face %s\nproperty list uchar int vertex_indices\nend_header\n",
            vertex_count, face_count);
    put_text(header);
    for (int v = 0; v < 4; v++) {
        put_value(F32, xy[v][0]);
        put_value(F32, xy[v][1]);
        put_value(F32, 0.5);
        end_row();
    }
    put_value(U8, 4);
    for (int k = 0; k < 4; k++) put_value(I32, k);
    end_row();
}

static void check_square(const void *bytes, size_t size)
{
    static const uint32_t fan[6] = {0, 1, 2, 0, 2, 3};
    static const float xyz[12] = {0, 0, 0.5, 1, 0, 0.5, 1, 1, 0.5, 0, 1, 0.5};
    bvx_mesh m;

    TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_OK, read_file(bytes, size, PLY, &m), bvx_last_message(ctx));
    TEST_ASSERT_EQUAL_UINT64(4, m.vertex_count);
    TEST_ASSERT_EQUAL_UINT64(2, m.triangle_count);
    TEST_ASSERT_EQUAL_UINT32_ARRAY(fan, m.triangles, 6);
    TEST_ASSERT_EQUAL_INT32(BVX_F32, m.position_type);
    TEST_ASSERT_EQUAL_MEMORY(xyz, m.positions, sizeof xyz);
    bvx_mesh_free(ctx, &m);
}

static void test_read_ply_square(void)
{
    for (int how = ASCII; how <= BIG; how++) {
        put_square(how, "4", "1");
        check_square(file, file_size);
        put_text("trailing bytes");
        check_square(file, file_size);
    }
}

/* ---- any layout: random elements and properties, three encodings, against what was meant ---- */

enum { X, Y, Z, RED, GREEN, BLUE, ALPHA, U, V, CORNERS, CORNER_UVS, NOISE };

typedef struct layout_property {
    int type, count_type; /* count_type -1: no list */
    int role, set;        /* set: which of the names for a role */
} layout_property;

typedef struct layout {
    layout_property p[60];
    int n;
} layout;

static uint64_t layout_state;

static int below(int n)
{
    return (int)(next_random(&layout_state) % (uint64_t)n);
}

static void add_property(layout *l, int role, int type, int count_type, int set)
{
    layout_property const p = {type, count_type, role, set};
    l->p[l->n++] = p;
}

static void add_noise(layout *l)
{
    for (int n = below(3); n > 0; n--) add_property(l, NOISE, below(8), below(2) == 0 ? -1 : below(6), 0);
}

/* spelling: which names of types and of the list are taken, and what space */
static void put_properties(const layout *l, int spelling)
{
    static const char *const names[][4] = {{"x"},
                                           {"y"},
                                           {"z"},
                                           {"red", "diffuse_red", "r", "red"},
                                           {"green", "diffuse_green", "g", "green"},
                                           {"blue", "diffuse_blue", "b", "blue"},
                                           {"alpha", "diffuse_alpha", "a", "alpha"},
                                           {"s", "u", "texture_u", "texture_s"},
                                           {"t", "v", "texture_v", "texture_t"},
                                           {"vertex_indices", "vertex_index"},
                                           {"texcoord"}};
    char text[100];

    for (int i = 0; i < l->n; i++) {
        const layout_property *const p = &l->p[i];
        if (p->role != NOISE) sprintf(text, "%s", names[p->role][p->set]);
        else sprintf(text, "noise%d", i);
        put_text(spelling & 2 ? "property\t " : "property ");
        if (p->count_type >= 0) {
            put_text("list ");
            put_text(types[p->count_type][spelling & 1]);
            put_text(" ");
        }
        put_text(types[p->type][spelling & 1]);
        put_text(" ");
        put_text(text);
        put_text("\n");
    }
}

static void put_noise(const layout_property *p)
{
    int const n = p->count_type < 0 ? 1 : below(5);
    if (p->count_type >= 0) put_value(p->count_type, n);
    for (int i = 0; i < n; i++) put_value(p->type, below(100));
}

enum { MOST_VERTICES = 60, MOST_FACES = 40, MOST_CORNERS = 8 };

typedef struct meaning {
    double xyz[MOST_VERTICES][3];
    int colours[MOST_VERTICES][4];
    float uvs[MOST_VERTICES][2], corner_uvs[MOST_FACES][MOST_CORNERS][2];
    int corners[MOST_FACES], corner[MOST_FACES][MOST_CORNERS];
    int vertices, faces, has_colours, has_alpha, has_uvs; /* has_uvs: 1 at vertices, 2 at corners */
    /* its texture coordinates are missing; -1: none is */
    int bare_face;
} meaning;

static meaning meant;

/* A value fit for a role, as the type holds it. */
static double any_value(const layout_property *p)
{
    if (p->role >= RED && p->role <= ALPHA) {
        double const share = below(1001) / 1000.0;
        return p->type == F32   ? (double)(float)share
               : p->type == F64 ? share
                                : below(p->type == U16 ? 65536 : 256);
    }
    double const v = below(100);
    return p->type == F32 ? (double)(float)(v / 7) : p->type == F64 ? v / -7 : p->type % 2 == 0 ? v - 50 : v;
}

static int meant_colour(int type, double v)
{
    return type >= F32 ? (int)(v * 255 + 0.5) : type == U16 ? ((int)v + 128) / 257 : (int)v;
}

static void put_vertices(const layout *l)
{
    for (int v = 0; v < meant.vertices; v++) {
        meant.colours[v][3] = 255;
        for (int i = 0; i < l->n; i++) {
            const layout_property *const p = &l->p[i];
            if (p->role == NOISE) {
                put_noise(p);
                continue;
            }
            double const value = any_value(p);
            if (p->role <= Z) meant.xyz[v][p->role] = value;
            else if (p->role <= ALPHA) meant.colours[v][p->role - RED] = meant_colour(p->type, value);
            else meant.uvs[v][p->role - U] = (float)value;
            put_value(p->type, value);
        }
        end_row();
    }
}

static void put_faces(const layout *l)
{
    for (int f = 0; f < meant.faces; f++) {
        int const corners = meant.corners[f] = below(3) > 0 ? 3 : 3 + below(MOST_CORNERS - 2);
        for (int i = 0; i < l->n; i++) {
            const layout_property *const p = &l->p[i];
            if (p->role == NOISE) {
                put_noise(p);
            } else if (p->role == CORNERS) {
                put_value(p->count_type, corners);
                for (int k = 0; k < corners; k++)
                    put_value(p->type, meant.corner[f][k] = below(meant.vertices));
            } else {
                put_value(p->count_type, f == meant.bare_face ? 0 : 2 * corners);
                for (int k = 0; k < 2 * corners && f != meant.bare_face; k++) {
                    double const value = any_value(p);
                    meant.corner_uvs[f][k / 2][k % 2] = (float)value;
                    put_value(p->type, value);
                }
            }
        }
        end_row();
    }
}

static void put_other(const layout *l, int rows)
{
    for (int r = 0; r < rows; r++) {
        for (int i = 0; i < l->n; i++) put_noise(&l->p[i]);
        if (l->n > 0) end_row();
    }
}

/* Coordinates, colours and texture coordinates in any order among others; half of all files have only floats,
 * and half have what belongs together side by side. */
static int32_t make_vertex_layout(layout *l)
{
    static const int colour_types[5] = {U8, U8, U16, F32, F64};
    int const kind = below(4);
    int const together = below(2);
    int const colour_type = colour_types[below(5)];
    int const uv_type = F32 + below(2);
    int const colour_set = below(3), uv_set = below(4);
    int roles[9], n = 0, all_float = 1;

    meant.has_colours = below(2);
    meant.has_alpha = meant.has_colours && below(2);
    meant.has_uvs = below(3);
    for (int a = X; a <= Z; a++) roles[n++] = a;
    for (int a = RED; a <= BLUE && meant.has_colours; a++) roles[n++] = a;
    if (meant.has_alpha) roles[n++] = ALPHA;
    for (int a = U; a <= V && meant.has_uvs == 1; a++) roles[n++] = a;
    for (int i = n - 1; i > 0 && !together; i--) {
        int const k = below(i + 1), role = roles[i];
        roles[i] = roles[k];
        roles[k] = role;
    }
    for (int i = 0; i < n; i++) {
        int const role = roles[i], type = kind < 2 ? F32 : kind == 2 ? F64 : below(8);
        if (!together || role == RED || role == U) add_noise(l);
        if (role <= Z) {
            add_property(l, role, type, -1, 0);
            all_float &= type == F32;
        } else add_property(l, role, role >= U ? uv_type : colour_type, -1, role >= U ? uv_set : colour_set);
    }
    if (!together) add_noise(l);
    return all_float ? BVX_F32 : BVX_F64;
}

/* Returns the type of positions that must come out. */
static int32_t put_any_layout(int how)
{
    layout vertex = {{{0, 0, 0, 0}}, 0}, face = vertex, other[3] = {vertex, vertex, vertex};
    int const names = below(4), face_first = below(2);
    int rows[3];
    char text[60];
    int32_t const type = make_vertex_layout(&vertex);
    int const uvs_first = below(2);

    meant.vertices = 1 + below(MOST_VERTICES);
    meant.faces = 1 + below(MOST_FACES);
    meant.bare_face = below(4) == 0 ? below(meant.faces) : -1;
    if (below(2) == 0) add_noise(&face);
    if (meant.has_uvs == 2 && uvs_first) add_property(&face, CORNER_UVS, F32 + below(2), below(6), 0);
    add_property(&face, CORNERS, below(6), below(6), below(2));
    if (meant.has_uvs == 2 && !uvs_first) add_property(&face, CORNER_UVS, F32 + below(2), below(6), 0);
    if (below(2) == 0) add_noise(&face);
    for (int i = 0; i < 3; i++) {
        add_noise(&other[i]);
        rows[i] = below(5);
    }
    begin_header(how);
    for (int i = 0; i < 5; i++) {
        int const is_vertex = i == (face_first ? 3 : 1), is_face = i == (face_first ? 1 : 3);
        const layout *const l = is_vertex ? &vertex : is_face ? &face : &other[i / 2];
        put_text(i % 2 == 0 ? "comment element face 7\nobj_info x\n" : "");
        sprintf(text, "element %s %d\n",
                is_vertex ? "vertex"
                : is_face ? "face"
                          : "other",
                is_vertex ? meant.vertices
                : is_face ? meant.faces
                          : rows[i / 2]);
        put_text(text);
        put_properties(l, names);
    }
    put_text("end_header\n");
    put_other(&other[0], rows[0]);
    if (face_first) put_faces(&face);
    else put_vertices(&vertex);
    put_other(&other[1], rows[1]);
    if (face_first) put_vertices(&vertex);
    else put_faces(&face);
    put_other(&other[2], rows[2]);
    return type;
}

static uint64_t meant_triangles(void)
{
    uint64_t n = 0;
    for (int f = 0; f < meant.faces; f++) n += (uint64_t)meant.corners[f] - 2;
    return n;
}

static void check_meant_vertices(const bvx_mesh *m)
{
    TEST_ASSERT_EQUAL_UINT64((uint64_t)meant.vertices, m->vertex_count);
    TEST_ASSERT_EQUAL_INT(meant.has_colours, m->colours != NULL);
    if (meant.has_uvs == 1) TEST_ASSERT_TRUE(m->uvs != NULL && m->uv_triangles == NULL);
    for (size_t v = 0; v < (size_t)meant.vertices; v++) {
        for (size_t a = 0; a < 3; a++) {
            double const c = m->position_type == BVX_F32 ? (double)((float *)m->positions)[3 * v + a]
                                                         : ((double *)m->positions)[3 * v + a];
            TEST_ASSERT_TRUE(c == meant.xyz[v][a]);
        }
        for (size_t c = 0; c < 4 && meant.has_colours; c++)
            TEST_ASSERT_EQUAL_UINT8(meant.colours[v][c], m->colours[4 * v + c]);
        for (size_t c = 0; c < 2 && meant.has_uvs == 1; c++)
            TEST_ASSERT_TRUE(m->uvs[2 * v + c] == meant.uvs[v][c]);
    }
}

static void check_meant_faces(const bvx_mesh *m)
{
    int const has_uvs = meant.has_uvs == 2 && meant.bare_face < 0;
    size_t t = 0;

    TEST_ASSERT_EQUAL_UINT64(meant_triangles(), m->triangle_count);
    TEST_ASSERT_EQUAL_INT(has_uvs, m->uv_triangles != NULL);
    TEST_ASSERT_EQUAL_INT(has_uvs || meant.has_uvs == 1, m->uvs != NULL);
    for (int f = 0; f < meant.faces; f++) {
        double corner[MOST_CORNERS][3];
        uint32_t cut[3 * MOST_CORNERS];
        for (int k = 0; k < meant.corners[f]; k++)
            memcpy(corner[k], meant.xyz[meant.corner[f][k]], sizeof corner[k]);
        cut_polygon((const double(*)[3])corner, (uint64_t)meant.corners[f], cut);
        for (int i = 0; i < 3 * (meant.corners[f] - 2); i++, t++) {
            TEST_ASSERT_EQUAL_UINT32(meant.corner[f][cut[i]], m->triangles[t]);
            for (size_t c = 0; c < 2 && has_uvs; c++)
                TEST_ASSERT_TRUE(m->uvs[2 * m->uv_triangles[t] + c] == meant.corner_uvs[f][cut[i]][c]);
        }
    }
}

static void test_read_ply_any_layout(void)
{
    layout_state = 17;
    for (int round = 0; round < 1500; round++) {
        bvx_mesh m;
        int32_t const type = put_any_layout(round % 3);
        TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_OK, read_file(file, file_size, PLY, &m), bvx_last_message(ctx));
        TEST_ASSERT_EQUAL_INT32(type, m.position_type);
        check_meant_vertices(&m);
        check_meant_faces(&m);
        bvx_mesh_free(ctx, &m);
        if (round % 100 < 3) check_every_limit(file, file_size, PLY);
    }
}

/* ---- colours and texture coordinates: which properties are taken ---- */

/* A triangle whose vertices have these properties with these values, the
 * same for each; NULL colour or uv: none. */
static void check_attributes(const char *properties, const char *values, const char *colour, const float *uv)
{
    char text[1000];
    bvx_mesh m;

    sprintf(
        text,
        "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n%s"
        "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0 %s\n1 0 0 %s\n0 1 0 %s\n3 0 1 2\n",
        properties, values, values, values);
    TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_OK, read_file(text, strlen(text), PLY, &m), bvx_last_message(ctx));
    TEST_ASSERT_EQUAL_INT_MESSAGE(colour != NULL, m.colours != NULL, text);
    TEST_ASSERT_EQUAL_INT_MESSAGE(uv != NULL, m.uvs != NULL, text);
    for (size_t v = 0; v < 3; v++) {
        char got[10];
        if (colour != NULL) {
            sprintf(got, "%02x%02x%02x%02x", m.colours[4 * v], m.colours[4 * v + 1], m.colours[4 * v + 2],
                    m.colours[4 * v + 3]);
            TEST_ASSERT_EQUAL_STRING_MESSAGE(colour, got, text);
        }
        if (uv != NULL) TEST_ASSERT_TRUE(m.uvs[2 * v] == uv[0] && m.uvs[2 * v + 1] == uv[1]);
    }
    bvx_mesh_free(ctx, &m);
}

static void test_read_ply_attributes(void)
{
    static const float uv[2] = {0.25f, -3};

#define P(type, name) "property " type " " name "\n"
    check_attributes(P("uchar", "red") P("uchar", "green") P("uchar", "blue"), "1 2 255", "0102ffff", NULL);
    check_attributes(P("uchar", "red") P("uchar", "green"), "1 2", NULL, NULL);
    check_attributes(P("uchar", "red") P("uchar", "green") P("uchar", "b"), "1 2 3", NULL, NULL);
    check_attributes(P("uchar", "red") P("uchar", "alpha"), "1 2", NULL, NULL);
    check_attributes(P("uchar", "r") P("uchar", "red") P("uchar", "green") P("uchar", "blue"), "9 1 2 3",
                     "010203ff", NULL);
    check_attributes(P("uchar", "diffuse_red") P("uchar", "diffuse_green") P("uchar", "diffuse_blue")
                         P("uchar", "red") P("uchar", "green") P("uchar", "blue") P("uchar", "a"),
                     "9 9 9 1 2 3 7", "010203ff", NULL);
    check_attributes(P("ushort", "b") P("float", "g") P("int", "r") P("double", "a"), "65535 0.5 300 -1",
                     "ff80ff00", NULL);
    check_attributes(P("ushort", "red") P("ushort", "green") P("ushort", "blue"), "128 129 65406", "0001feff",
                     NULL);
    check_attributes("property list uchar uchar red\n" P("uchar", "green") P("uchar", "blue"), "1 1 2 3",
                     NULL, NULL);
    check_attributes(P("float", "s") P("float", "t"), "0.25 -3", NULL, uv);
    check_attributes(P("float", "v") P("double", "u"), "-3 0.25", NULL, uv);
    check_attributes(P("float", "s") P("float", "u") P("float", "v"), "9 0.25 -3", NULL, uv);
    check_attributes(P("float", "texture_u") P("float", "texture_v") P("short", "s") P("char", "red"),
                     "0.25 -3 1 1", NULL, uv);
    check_attributes(P("float", "texture_s") P("float", "v") P("float", "texture_t"), "0.25 9 -3", NULL, uv);
    check_attributes(P("float", "s") P("float", "v"), "0.25 9", NULL, NULL);
    check_attributes(P("float", "s"), "nan", NULL, NULL); /* nobody wants it */
#define VERTICES(more) \
    "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n" more
#define ONE_FACE(more) "element face 1\nproperty list uchar int vertex_indices\n" more "end_header\n"
    check_refused_text(VERTICES(P("float", "red") P("float", "green") P("float", "blue"))
                           ONE_FACE("") "0 0 0 1 1 1\n1 0 0 1 inf 1\n0 1 0 1 1 1\n3 0 1 2\n",
                       PLY, BVX_ERR_RANGE, "vertex 1 (line 14) has a colour that is not finite");
    check_refused_text(VERTICES(P("double", "u") P("float", "v"))
                           ONE_FACE("") "0 0 0 1 1\n1 0 0 1e39 1\n0 1 0 1 1\n3 0 1 2\n",
                       PLY, BVX_ERR_RANGE, "vertex 1 (line 13) has a texture coordinate that is not finite");
    check_refused_text(
        VERTICES("")
            ONE_FACE("property list uchar float texcoord\n") "0 0 0\n1 0 0\n0 1 0\n3 0 1 2 6 0 0 0 nan 0 0\n",
        PLY, BVX_ERR_RANGE, "face 0 (line 14) has a texture coordinate that is not finite");
    check_refused_text(
        VERTICES("")
            ONE_FACE("property list uchar float texcoord\n") "0 0 0\n1 0 0\n0 1 0\n3 0 1 2 5 0 0 0 0 0\n",
        PLY, BVX_ERR_FORMAT, "face 0 (line 14) has 3 corners and 5 numbers in texcoord");
    check_refused_text(VERTICES(P("uchar", "red") P("uchar", "red")) ONE_FACE(""), PLY, BVX_ERR_FORMAT,
                       "line 8: a second property");
}

/* Those of vertices come before those of corners. */
static void test_read_ply_both_texture_coordinates(void)
{
    static const char text[] = VERTICES(P("float", "s") P("float", "t")) ONE_FACE(
        "property list uchar float texcoord\n") "0 0 0 1 2\n1 0 0 3 4\n0 1 0 5 6\n3 0 1 2 6 9 9 9 9 9 9\n";
    static const float uvs[6] = {1, 2, 3, 4, 5, 6};
    bvx_mesh m;

    TEST_ASSERT_EQUAL_INT32(BVX_OK, read_file(text, strlen(text), PLY, &m));
    TEST_ASSERT_NULL(m.uv_triangles);
    TEST_ASSERT_EQUAL_MEMORY(uvs, m.uvs, sizeof uvs);
    bvx_mesh_free(ctx, &m);
}

/* ---- strips ---- */

/* A file of 6 vertices with strips of these numbers (ended by -2), and a
 * face before or behind them (0: none). */
static void put_strips(int how, const int *const *strips, int count, int face)
{
    char text[300];

    begin_header(how);
    put_text("element vertex 6\nproperty float x\nproperty float y\nproperty float z\n");
    if (face == 1) put_text("element face 1\nproperty list uchar int vertex_indices\n");
    sprintf(text, "element tristrips %d\nproperty list int int vertex_indices\n", count);
    put_text(text);
    if (face == 2) put_text("element face 1\nproperty list uchar int vertex_indices\n");
    put_text("end_header\n");
    for (int v = 0; v < 18; v++) put_value(F32, v * v);
    for (int part = 1; part <= 2; part++) {
        if (part == face)
            for (int k = 0; k < 4; k++) put_value(k == 0 ? U8 : I32, k == 0 ? 3 : k);
        for (int i = 0; i < count && part == (face == 1 ? 2 : 1); i++) {
            int n = 0;
            while (strips[i][n] != -2) n++;
            put_value(I32, n);
            for (int k = 0; k < n; k++) put_value(I32, strips[i][k]);
        }
    }
}

static void test_read_ply_strips(void)
{
    static const int one[] = {0, 1, 2, 3, 4, -1, 5, 4, 3, -2};
    static const int two[] = {-1, 0, 1, -1, -1, 2, 3, 3, 3, 5, 4, -1, -2};
    static const int none[] = {-2};
    static const int bad[] = {0, 1, 2, 6, -2}, worse[] = {0, 1, 2, -3, -2}, flat[] = {0, 1, 1, 0, -2};
    static const uint32_t want[] = {0, 1, 2, 2, 1, 3, 2, 3, 4, 5, 4, 3, /* two: */ 5, 3, 4};
    static const uint32_t face_triangle[] = {1, 2, 3};
    const int *const strips[] = {one, none, two};

    for (int how = ASCII; how <= BIG; how++)
        for (int face = 0; face <= 2; face++) {
            bvx_mesh m;
            put_strips(how, strips, 3, face);
            TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_OK, read_file(file, file_size, PLY, &m),
                                            bvx_last_message(ctx));
            TEST_ASSERT_EQUAL_UINT64(5 + (face > 0), m.triangle_count);
            TEST_ASSERT_EQUAL_UINT32_ARRAY(want, m.triangles + (face == 1 ? 3 : 0), 15);
            if (face > 0)
                TEST_ASSERT_EQUAL_UINT32_ARRAY(face_triangle, m.triangles + (face == 1 ? 0 : 15), 3);
            bvx_mesh_free(ctx, &m);
            check_every_limit(file, file_size, PLY);
            TEST_ASSERT_TRUE(check_every_prefix(file, file_size, PLY, 5 + (face > 0)) >= 1);
            put_strips(how, (const int *const[]){bad}, 1, face);
            check_refused(file, file_size, PLY, BVX_ERR_RANGE, "strip 0 ");
            check_refused(file, file_size, PLY, BVX_ERR_RANGE, "names vertex 6, but there are 6");
            put_strips(how, (const int *const[]){worse}, 1, face);
            check_refused(file, file_size, PLY, BVX_ERR_RANGE, "names vertex -3");
        }
    put_strips(LITTLE, (const int *const[]){flat}, 1, 0);
    check_refused(file, file_size, PLY, BVX_ERR_EMPTY, "no triangle");
    put_strips(LITTLE, strips, 0, 0);
    check_refused(file, file_size, PLY, BVX_ERR_EMPTY, "no faces");
    check_refused_text(
        VERTICES("") "element tristrips 1\nproperty list int int other\nend_header\n0 0 0\n1 0 0\n0 1 0\n0\n",
        PLY, BVX_ERR_FORMAT, "line 7: element tristrips has no list vertex_indices");
}

/* ---- line ends, spaces, indices ---- */

static void test_read_ply_line_ends(void)
{
    static uint8_t other[4000];

    for (int how = ASCII; how <= BIG; how++)
        for (int returns = 0; returns < 2; returns++) { /* "\r\n", then "\r" */
            size_t n = 0, i = 0;
            put_square(how, "4", "1");
            for (; memcmp(file + i, "end_header", 10) != 0; i++) {
                if (file[i] == '\n') other[n++] = '\r';
                if (file[i] != '\n' || returns == 0) other[n++] = file[i];
            }
            n += (size_t)sprintf((char *)other + n, returns == 0 ? "end_header\r\n" : "end_header\r");
            memcpy(other + n, file + i + 11, file_size - i - 11);
            check_square(other, n + file_size - i - 11);
        }

    /* data that begins with the byte of a newline, behind lines that end with a carriage return */
    begin_header(LITTLE);
    put_text(
        "element a 1\nproperty uchar b\nelement vertex 1\nproperty uchar x\nproperty uchar y\nproperty uchar z\n"
        "element face 1\nproperty list uchar uchar vertex_index\nend_header\n");
    for (size_t i = 0; i < file_size; i++)
        if (file[i] == '\n') file[i] = '\r';
    put_text("\n\n\n\n");
    memcpy(file + file_size, "\003\0\0\0", 4);
    bvx_mesh m;
    TEST_ASSERT_EQUAL_INT32(BVX_OK, read_file(file, file_size + 4, PLY, &m));
    TEST_ASSERT_TRUE(((double *)m.positions)[2] == 10);
    bvx_mesh_free(ctx, &m);
    static const char loose[] =
        "ply \nformat\tascii  1.0 \ncomment\n  element vertex 4 \nproperty  float x\nproperty float y\n"
        "property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header \n"
        "0 0 .5 1\t0 0.5\n\n\n1 1 5e-1 0 +1 0.5 4 0 1 2\r\n3";
    check_square(loose, strlen(loose));
}

static void test_read_ply_corner_types_reach_their_ends(void)
{
    static const struct {
        int type;
        double value;
    } cases[] = {{I8, 127},    {U8, 128},    {U8, 255},    {I16, 32767},
                 {U16, 32768}, {U16, 65535}, {I32, 65536}, {U32, 65536}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++)
        for (int how = ASCII; how <= BIG; how++) {
            char text[300];
            bvx_mesh m;
            begin_header(how);
            sprintf(
                text,
                "element vertex 65537\nproperty uchar x\nproperty char y\nproperty char z\nelement face 1\n"
                "property list uchar %s vertex_indices\nend_header\n",
                types[cases[i].type][0]);
            put_text(text);
            for (int v = 0; v < 3 * 65537; v++) put_value(U8, 7);
            put_value(U8, 3);
            for (int k = 0; k < 3; k++) put_value(cases[i].type, k == 0 ? cases[i].value : k);
            TEST_ASSERT_EQUAL_INT32(BVX_OK, read_file(file, file_size, PLY, &m));
            TEST_ASSERT_EQUAL_UINT32((uint32_t)cases[i].value, m.triangles[0]);
            bvx_mesh_free(ctx, &m);
        }
}

/* ---- refusals ---- */

static void test_read_ply_refuses_counts(void)
{
    static const char *const counts[] = {"5",
                                         "100000000",
                                         "2147483648",
                                         "4294967295",
                                         "4294967296",
                                         "18446744073709551615",
                                         "18446744073709551616",
                                         "99999999999999999999999999"};
    static const char *const malformed[] = {"-1", "1.0", "", "x", "0x4", "+4", "4x"};

    for (int how = ASCII; how <= BIG; how++) {
        for (size_t i = 0; i < sizeof counts / sizeof counts[0]; i++) {
            put_square(how, counts[i], "1");
            check_refused(file, file_size, PLY, BVX_ERR_FORMAT,
                          i > 0          ? "line 4: "
                          : how == ASCII ? "face 0"
                                         : "line 8: ");
            put_square(how, "4", counts[i]);
            check_refused(file, file_size, PLY, BVX_ERR_FORMAT, "line 8: ");
            TEST_ASSERT_TRUE(bvx_memory_peak(ctx) < 4096); /* the header's tables at most */
        }
        for (size_t i = 0; i < sizeof malformed / sizeof malformed[0]; i++) {
            put_square(how, malformed[i], "1");
            check_refused(file, file_size, PLY, BVX_ERR_FORMAT, "line 4: ");
            check_refused(file, file_size, PLY, BVX_ERR_FORMAT, "a count of rows");
            put_square(how, "4", malformed[i]);
            check_refused(file, file_size, PLY, BVX_ERR_FORMAT, "line 8: ");
            check_refused(file, file_size, PLY, BVX_ERR_FORMAT, "a count of rows");
        }
        put_square(how, "4", "0");
        check_refused(file, file_size, PLY, BVX_ERR_EMPTY, "no faces");
        put_square(how, "0", "1");
        TEST_ASSERT_TRUE(read_file(file, file_size, PLY, &(bvx_mesh){0}) != BVX_OK);
        put_square(how, "1", "1");
        TEST_ASSERT_TRUE(read_file(file, file_size, PLY, &(bvx_mesh){0}) != BVX_OK);
    }
}

static void test_read_ply_refuses_corners(void)
{
    static const double corners[] = {4, 255, 65536, 2147483647, -1, -2147483648.0};
    char words[60];

    for (int how = ASCII; how <= BIG; how++)
        for (int length = 3; length <= 4; length++)
            for (size_t i = 0; i < sizeof corners / sizeof corners[0]; i++) {
                put_square(how, "4", "2");
                put_value(U8, length);
                for (int k = 0; k < length; k++) put_value(I32, k == length - 1 ? corners[i] : k);
                sprintf(words, "names vertex %.0f, but there are 4", corners[i]);
                check_refused(file, file_size, PLY, BVX_ERR_RANGE, words);
                check_refused(file, file_size, PLY, BVX_ERR_RANGE,
                              how == ASCII ? "face 1 (line 16)" : "face 1 (byte ");
            }
    for (int how = ASCII; how <= BIG; how++)
        for (int length = 0; length < 3; length++) {
            put_square(how, "4", "2");
            put_value(U8, length);
            for (int k = 0; k < 3; k++) put_value(I32, k);
            sprintf(words, "has %d corners", length);
            check_refused(file, file_size, PLY, BVX_ERR_FORMAT, words);
        }
}

static void test_read_ply_refuses_numbers(void)
{
    static const uint32_t bad[] = {0x7f800000u, 0xff800000u, 0x7fc00000u};

    for (int big = 0; big < 2; big++)
        for (int at = 0; at < 12; at++)
            for (size_t i = 0; i < 3; i++) {
                char words[100];
                put_square(big ? BIG : LITTLE, "4", "1");
                put_u32(file + file_size - 17 - 48 + 4 * at, bad[i], big);
                sprintf(words, "PLY: vertex %d (byte %u) has a coordinate that is not finite", at / 3,
                        (unsigned)(file_size - 17 - 48 + 12 * (size_t)(at / 3)));
                check_refused(file, file_size, PLY, BVX_ERR_RANGE, words);
            }
#define HEAD                                                                                          \
    "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n" \
    "element face 1\nproperty list uchar int vertex_indices\nend_header\n"
    check_refused_text(HEAD "0 0 0 1 0 nan\n0 1 0\n3 0 1 2\n", PLY, BVX_ERR_RANGE, "vertex 1 (line 10)");
    check_refused_text(HEAD "0 0 0\n1 -inf 0\n0 1 0\n3 0 1 2\n", PLY, BVX_ERR_RANGE, "vertex 1 (line 11)");
    check_refused_text(HEAD "0 0 0\n1 0 0\n0 1 1e39\n3 0 1 2\n", PLY, BVX_ERR_RANGE, "vertex 2 (line 12)");
    check_refused_text(HEAD "0 0 0\n1 0,5 0\n0 1 0\n3 0 1 2\n", PLY, BVX_ERR_FORMAT,
                       "line 11: expected a coordinate, found '0,5'");
    check_refused_text(HEAD "0 0 0\n1 0 0\n0 1 0\n3 0 1 2x\n", PLY, BVX_ERR_FORMAT,
                       "line 13: expected a vertex index, found '2x'");
    check_refused_text(HEAD "0 0 0\n1 0 0\n0 1 0\n3 0 1 2.0\n", PLY, BVX_ERR_FORMAT,
                       "line 13: expected a vertex index");
    check_refused_text(HEAD "0 0 0\n1 0 0\n0 1 0\n3 0 1 99999999999999999999999\n", PLY, BVX_ERR_RANGE,
                       "face 0 (line 13)");
    check_refused_text(HEAD "0 0 0\n1 0 0\n0 1 0\nx 0 1 2\n", PLY, BVX_ERR_FORMAT,
                       "line 13: expected the length of a list");
    check_refused_text(HEAD "0 0 0\n1 0 0\n0 1 0\n-3 0 1 2\n", PLY, BVX_ERR_FORMAT, "a list of -3");
    check_refused_text(HEAD "0 0 0\n1 0 0\n0 1 0\n99 0 1 2\n", PLY, BVX_ERR_FORMAT, "the file ends");
}

static void test_read_ply_refuses_headers(void)
{
#define XYZ  "property float x\nproperty float y\nproperty float z\n"
#define FACE "element face 1\nproperty list uchar int vertex_indices\n"
#define ROWS "0 0 0\n3 0 0 0\n"
    static const struct {
        const char *text;
        bvx_status status;
        const char *words;
    } bad[] = {
        {"", BVX_ERR_EMPTY, "PLY: the file has no bytes"},
        {"ply", BVX_ERR_FORMAT, "line 'ply'"},
        {"plyx\n", BVX_ERR_FORMAT, "line 'ply'"},
        {" ply\n", BVX_ERR_FORMAT, "line 'ply'"},
        {"solid\n", BVX_ERR_FORMAT, "line 'ply'"},
        {"ply\n", BVX_ERR_FORMAT, "ends before end_header"},
        {"ply\nend_header", BVX_ERR_FORMAT, "ends before end_header"},
        {"ply\nend_header\n", BVX_ERR_FORMAT, "no line 'format'"},
        {"ply\nformat ascii 1.0\nend_header\n", BVX_ERR_EMPTY, "no faces"},
        {"ply\nformat ascii 1.0\nelement vertex 1\n" XYZ "end_header\n0 0 0\n", BVX_ERR_EMPTY, "no faces"},
        {"ply\nformat ascii 2.0\nend_header\n", BVX_ERR_FORMAT, "line 2: expected version 1.0"},
        {"ply\nformat ascii 1.0 x\nend_header\n", BVX_ERR_FORMAT, "line 2: expected the end of the line"},
        {"ply\nformat binary 1.0\nend_header\n", BVX_ERR_FORMAT, "line 2: expected ascii"},
        {"ply\nformat ascii 1.0\nformat ascii 1.0\nend_header\n", BVX_ERR_FORMAT, "line 3"},
        {"ply\nformat ascii 1.0\nnonsense\nend_header\n", BVX_ERR_FORMAT, "line 3: expected format, element"},
        {"ply\nformat ascii 1.0\n\nend_header\n", BVX_ERR_FORMAT, "line 3: the line ends"},
        {"ply\nformat ascii 1.0\nproperty float x\nend_header\n", BVX_ERR_FORMAT,
         "line 3: a property before any element"},
        {"ply\nformat ascii 1.0\nelement\nend_header\n", BVX_ERR_FORMAT,
         "line 3: the line ends where an element's name"},
        {"ply\nformat ascii 1.0\nelement vertex\nend_header\n", BVX_ERR_FORMAT,
         "line 3: the line ends where a count"},
        {"ply\nformat ascii 1.0\nelement vertex 1 1\nend_header\n", BVX_ERR_FORMAT,
         "line 3: expected the end"},
        {"ply\nformat ascii 1.0\nelement a 0\nproperty half x\nend_header\n", BVX_ERR_FORMAT,
         "line 4: expected a type"},
        {"ply\nformat ascii 1.0\nelement a 0\nproperty float\nend_header\n", BVX_ERR_FORMAT,
         "line 4: the line ends where a prop"},
        {"ply\nformat ascii 1.0\nelement a 0\nproperty list float int x\nend_header\n", BVX_ERR_FORMAT,
         "expected an integer type"},
        {"ply\nformat ascii 1.0\nelement a 0\nproperty list uchar\nend_header\n", BVX_ERR_FORMAT,
         "line 4: the line ends"},
        {"ply\nformat ascii 1.0\nelement vertex 1\n" XYZ XYZ FACE "end_header\n" ROWS, BVX_ERR_FORMAT,
         "line 7: a second property"},
        {"ply\nformat ascii 1.0\nelement vertex 1\nproperty list uchar float x\n" FACE "end_header\n" ROWS,
         BVX_ERR_FORMAT, "line 4: a coordinate cannot be a list"},
        {"ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\n" FACE
         "end_header\n" ROWS,
         BVX_ERR_FORMAT, "line 3: element vertex has no property z"},
        {"ply\nformat ascii 1.0\n" FACE "end_header\n" ROWS, BVX_ERR_FORMAT, "no element vertex"},
        {"ply\nformat ascii 1.0\nelement vertex 1\n" XYZ FACE FACE "end_header\n" ROWS ROWS, BVX_ERR_FORMAT,
         "line 9: a second element"},
        {"ply\nformat ascii 1.0\nelement vertex 1\n" XYZ
         "element face 1\nproperty list uchar float vertex_indices\nend_header\n" ROWS,
         BVX_ERR_FORMAT, "line 8: vertex indices must be integers"},
        {"ply\nformat ascii 1.0\nelement vertex 1\n" XYZ
         "element face 1\nproperty list uchar int other\nend_header\n" ROWS,
         BVX_ERR_FORMAT, "line 7: element face has no list vertex_indices"},
        {"ply\nformat ascii 1.0\nelement vertex 1\n" XYZ
         "element face 1\nproperty int vertex_indices\nend_header\n" ROWS,
         BVX_ERR_FORMAT, "line 7: element face has no list"},
        {"ply\nformat ascii 1.0\nelement vertex 1\n" XYZ FACE "end_headerx\n" ROWS, BVX_ERR_FORMAT,
         "ends before end_header"},
    };
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++)
        check_refused_text(bad[i].text, PLY, bad[i].status, bad[i].words);
    static const char elements_without_properties[] =
        "ply\nformat ascii 1.0\nelement none 18446744073709551615\nelement vertex 1\n" XYZ FACE
        "end_header\n" ROWS;
    bvx_mesh m;
    TEST_ASSERT_EQUAL_INT32(
        BVX_OK, read_file(elements_without_properties, strlen(elements_without_properties), PLY, &m));
    bvx_mesh_free(ctx, &m);
}

static void test_read_ply_every_header_count(void)
{
    for (int how = ASCII; how <= BIG; how++) {
        put_square(how, "4", "1");
        TEST_ASSERT_EQUAL_INT(0, check_every_count(file, file_size, PLY) - 1); /* one face is what it has */
    }
    layout_state = 29;
    for (int round = 0; round < 30; round++) {
        put_any_layout(round % 3);
        check_every_count(file, file_size, PLY);
    }
    static const int strip[] = {0, 1, 2, 3, 4, 5, -2};
    for (int how = ASCII; how <= BIG; how++) {
        put_strips(how, (const int *const[]){strip}, 1, 0);
        TEST_ASSERT_EQUAL_INT(1, check_every_count(file, file_size, PLY)); /* one strip */
    }
}

/* Lengths of lists and numbers of corners, as the file has them in four bytes, replaced. */
static void test_read_ply_every_list_length(void)
{
    static const uint32_t values[] = {0, 1, 0xffffffffu, 0x80000000u, 0x7fffffffu, 3, 0x55555556u};
    static const int strip[] = {0, 1, 2, 3, 4, 5, -2};

    for (int how = LITTLE; how <= BIG; how++)
        for (int kind = 0; kind < 2; kind++) {
            static uint8_t other[4000];
            if (kind == 0) put_strips(how, (const int *const[]){strip}, 1, 2);
            else {
                begin_header(how);
                put_text(
                    "element vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement face 1\n"
                    "property list uint int a\nproperty list uint uint vertex_index\nproperty list int float texcoord\n"
                    "end_header\n");
                for (int i = 0; i < 9; i++) put_value(F32, i * i);
                put_value(U32, 2);
                for (int i = 0; i < 2; i++) put_value(I32, i);
                put_value(U32, 3);
                for (int i = 0; i < 3; i++) put_value(U32, i);
                put_value(I32, 6);
                for (int i = 0; i < 6; i++) put_value(F32, i);
            }
            for (size_t at = file_size - 60; at + 4 <= file_size; at++)
                for (size_t i = 0; i < sizeof values / sizeof values[0]; i++) {
                    bvx_mesh m;
                    memcpy(other, file, file_size);
                    put_u32(other + at, values[i], how == BIG);
                    if (read_file(other, file_size, PLY, &m) == BVX_OK) bvx_mesh_free(ctx, &m);
                }
        }
}

/* Polygons whose corners take a byte each: one large one (read_file holds
 * it to its bound), and many of four corners. */
static void test_read_ply_memory_of_polygons(void)
{
    for (int kind = 0; kind < 2; kind++) {
        int const faces = kind == 0 ? 1 : 12000, corners = kind == 0 ? 3000 : 4;
        uint64_t state = 3;
        char text[300];
        bvx_mesh m;
        begin_header(LITTLE);
        sprintf(text,
                "element vertex 250\nproperty uchar x\nproperty uchar y\nproperty uchar z\nelement face %d\n"
                "property list int uchar vertex_index\nend_header\n",
                faces);
        put_text(text);
        for (int v = 0; v < 750; v++) file[file_size++] = (uint8_t)(next_random(&state) >> 32 & 0xff);
        for (int f = 0; f < faces; f++) {
            put_value(I32, corners);
            for (int k = 0; k < corners; k++) file[file_size++] = (uint8_t)(next_random(&state) % 250);
        }
        TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_OK, read_file(file, file_size, PLY, &m), bvx_last_message(ctx));
        TEST_ASSERT_EQUAL_UINT64((uint64_t)(faces * (corners - 2)), m.triangle_count);
        if (kind == 1) TEST_ASSERT_TRUE(bvx_memory_peak(ctx) < 5 * (uint64_t)file_size);
        bvx_mesh_free(ctx, &m);
    }
}

static void test_read_ply_every_prefix(void)
{
    for (int how = ASCII; how <= BIG; how++) {
        put_square(how, "4", "1");
        int const good = check_every_prefix(file, file_size, PLY, 2);
        TEST_ASSERT_EQUAL_INT(how == ASCII ? 2 : 1, good); /* a text may lack its last newline */
    }
    /* and with lists and other elements; those after the last one that is wanted may be cut */
    layout_state = 23;
    for (int round = 0; round < 6; round++) {
        put_any_layout(round % 3);
        TEST_ASSERT_TRUE(check_every_prefix(file, file_size, PLY, meant_triangles()) >= 1);
    }
}

/* Every byte of small files replaced: no crash, no leak, a valid mesh or an error. */
static void test_read_ply_every_byte_changed(void)
{
    static const uint8_t values[] = {0, 1, 0x7f, 0x80, 0xff, '\n', '9', '-'};

    for (int how = ASCII; how <= BIG; how++) {
        put_square(how, "4", "1");
        for (size_t i = 0; i < file_size; i++)
            for (size_t k = 0; k < sizeof values; k++) {
                bvx_mesh m;
                uint8_t const old = file[i];
                file[i] = values[k];
                if (read_file(file, file_size, PLY, &m) == BVX_OK) bvx_mesh_free(ctx, &m);
                file[i] = old;
            }
    }
}

static void test_read_ply_cancels(void)
{
    for (int how = ASCII; how <= BIG; how++) {
        int const rows = how == ASCII ? 150000 : 65000;
        uint8_t *const large = malloc(3 << 20);
        char text[300];
        size_t n;
        begin_header(how);
        sprintf(text,
                "element vertex %d\nproperty uchar x\nproperty uchar y\nproperty uchar z\nelement face 1\n"
                "property list uchar int vertex_indices\nend_header\n",
                rows);
        put_text(text);
        n = file_size;
        memcpy(large, file, n);
        file_size = 0;
        for (int i = 0; i < 1000; i++) put_value(U8, 1);
        for (int i = 0; i < 3 * rows; i += 1000, n += file_size) memcpy(large + n, file, file_size);
        file_size = 0;
        put_value(U8, 3);
        for (int k = 0; k < 3; k++) put_value(I32, k);
        memcpy(large + n, file, file_size);
        TEST_ASSERT_TRUE(check_every_cancel(large, n + file_size, PLY) >= 1);
        free(large);
    }
}

static void test_read_ply_real_file(void)
{
    static const char *const name = "../shared/meshes/two-boxes-bad-self-union.ply";
    FILE *const stream = fopen(name, "rb");
    double low[3] = {1e9, 1e9, 1e9}, high[3] = {-1e9, -1e9, -1e9};
    bvx_mesh m;

    if (stream == NULL) TEST_IGNORE_MESSAGE("../shared/meshes is not there");
    file_size = fread(file, 1, sizeof file, stream);
    fclose(stream);
    TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_OK, read_file(file, file_size, PLY, &m), bvx_last_message(ctx));
    TEST_ASSERT_EQUAL_UINT64(486, m.vertex_count);
    TEST_ASSERT_EQUAL_UINT64(708, m.triangle_count);
    TEST_ASSERT_EQUAL_INT32(BVX_F64, m.position_type);
    for (size_t i = 0; i < 3 * 486; i++) {
        double const v = ((double *)m.positions)[i];
        if (v < low[i % 3]) low[i % 3] = v;
        if (v > high[i % 3]) high[i % 3] = v;
    }
    for (int a = 0; a < 3; a++) TEST_ASSERT_TRUE(low[a] == -0.5 && high[a] == (a == 0 ? 1.0 : 0.5));
    bvx_mesh_free(ctx, &m);
    for (size_t n = 0; n < file_size; n += 101) TEST_ASSERT_TRUE(read_file(file, n, PLY, &m) != BVX_OK);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_read_ply_square);
    RUN_TEST(test_read_ply_any_layout);
    RUN_TEST(test_read_ply_attributes);
    RUN_TEST(test_read_ply_both_texture_coordinates);
    RUN_TEST(test_read_ply_strips);
    RUN_TEST(test_read_ply_line_ends);
    RUN_TEST(test_read_ply_corner_types_reach_their_ends);
    RUN_TEST(test_read_ply_refuses_counts);
    RUN_TEST(test_read_ply_refuses_corners);
    RUN_TEST(test_read_ply_refuses_numbers);
    RUN_TEST(test_read_ply_refuses_headers);
    RUN_TEST(test_read_ply_every_header_count);
    RUN_TEST(test_read_ply_every_list_length);
    RUN_TEST(test_read_ply_memory_of_polygons);
    RUN_TEST(test_read_ply_every_prefix);
    RUN_TEST(test_read_ply_every_byte_changed);
    RUN_TEST(test_read_ply_cancels);
    RUN_TEST(test_read_ply_real_file);
    return UNITY_END();
}
