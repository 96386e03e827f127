/* read_contour_table.c - contours as a table (CSV): a head line that names columns, a line for each point.
 *
 * Columns section, position, loop, x and y, in any order; label too where there are several bodies; z, nx,
 * ny and nz where planes have normals of their own; others are left alone. Words are parted by commas,
 * semicolons or tabs, whichever the head line has. Lines of one loop follow each other. Sections and loops
 * are known by what stands in their columns, so they may be numbers or names. A line without a loop and a
 * point states its section, which may have no loop at all: there is no body there. */
#include "core/key_tree.h"
#include "io/formats.h"
#include "io_contour/contour_text.h"

#include "mesh/mesh.h"

#include <math.h>

enum {
    TABLE_SECTION,
    TABLE_POSITION,
    TABLE_LOOP,
    TABLE_X,
    TABLE_Y,
    TABLE_LABEL, /* the first that may be missing */
    TABLE_Z,
    TABLE_NX,
    TABLE_NY,
    TABLE_NZ,
    TABLE_COLUMNS
};

typedef struct table_word {
    const char *at;
    size_t size;
} table_word;

typedef struct table_reader {
    bvxi_contour_file *f;
    char between;
    int32_t column[TABLE_COLUMNS];  /* where each stands, -1: nowhere */
    table_word word[TABLE_COLUMNS]; /* of the line */
    table_word loop, section;       /* of the loop that is being read */
    const char *line;
    double close_gap;
    uint64_t *section_hash; /* of each section's word */
    uint64_t *loop_hash;    /* of each loop's words */
    uint64_t section_room, loop_room;
    bvxi_key_tree sections; /* by these hashes */
    int planes;             /* each has a normal of its own, and points have a z */
} table_reader;

static table_word trim_word(const char *p, const char *end)
{
    table_word w;
    while (p < end && (bvxi_contour_blank(*p) || *p == '"')) p++;
    while (end > p && (bvxi_contour_blank(end[-1]) || end[-1] == '"')) end--;
    w.at = p;
    w.size = (size_t)(end - p);
    return w;
}

static int same_word(table_word a, table_word b)
{
    return a.size == b.size && (a.size == 0 || memcmp(a.at, b.at, a.size) == 0);
}

static bvx_status read_table_head(table_reader *r, const char *p, const char *end)
{
    static const char *const name[TABLE_COLUMNS] = {"section", "position", "loop", "x",  "y",
                                                    "label",   "z",        "nx",   "ny", "nz"};
    int32_t number = 0;

    /* The first separator in the head line is the file's: a name holds none of them. */
    r->between = ',';
    for (const char *c = p; c < end; c++)
        if (*c == ';' || *c == '\t') {
            r->between = *c;
            break;
        } else if (*c == ',') {
            break;
        }
    for (int i = 0; i < TABLE_COLUMNS; i++) r->column[i] = -1;

    for (;; number++) {
        const char *const stop = bvxi_find_byte(p, end, r->between);
        table_word const w = trim_word(p, stop);
        for (int i = 0; i < TABLE_COLUMNS; i++) {
            if (!bvxi_word_is(w.at, w.size, name[i])) continue;

            /* Which of two columns was meant cannot be known. */
            if (r->column[i] >= 0)
                return bvxi_contour_fail(r->f, r->line, BVX_ERR_FORMAT,
                                         "a column stands in the head line twice");
            r->column[i] = number;
        }
        if (stop == end) break;
        p = stop + 1;
    }

    for (int i = 0; i < TABLE_LABEL; i++)
        if (r->column[i] < 0)
            return BVXI_FILE_FAIL(
                r->f, BVX_ERR_FORMAT,
                "line 1: the head line has no column %s (section, position, loop, x, y are needed)", name[i]);
    /* A z without normals was always left alone; a part of a normal is a mistake. */
    r->planes = r->column[TABLE_NX] >= 0 || r->column[TABLE_NY] >= 0 || r->column[TABLE_NZ] >= 0;
    for (int i = TABLE_Z; i <= TABLE_NZ && r->planes; i++)
        if (r->column[i] < 0)
            return BVXI_FILE_FAIL(r->f, BVX_ERR_FORMAT,
                                  "line 1: the head line has no column %s (normals need z, nx, ny, nz)",
                                  name[i]);
    return BVX_OK;
}

static bvx_status split_table_line(table_reader *r, const char *p, const char *end)
{
    int found = 0, wanted = 0;

    /* A short line must not take the words that the line before it left. */
    for (int i = 0; i < TABLE_COLUMNS; i++) wanted += r->column[i] >= 0;
    for (int32_t number = 0;; number++) {
        const char *const stop = bvxi_find_byte(p, end, r->between);
        for (int i = 0; i < TABLE_COLUMNS; i++)
            if (r->column[i] == number) {
                r->word[i] = trim_word(p, stop);
                found++;
            }
        if (stop == end) break;
        p = stop + 1;
    }
    return found == wanted ? BVX_OK
                           : bvxi_contour_fail(r->f, r->line, BVX_ERR_FORMAT,
                                               "the line has fewer columns than the head line");
}

static bvx_status table_number(table_reader *r, int column, const char *what, double *value)
{
    table_word const w = r->word[column];
    /* The number must be the whole word: 1.5mm is refused rather than read as 1.5. */
    if (w.size == 0 || bvxi_parse_double(w.at, w.at + w.size, value) != w.size)
        return bvxi_contour_fail(r->f, r->line, BVX_ERR_FORMAT, what);
    if (!(*value - *value == 0.0))
        return bvxi_contour_fail(r->f, r->line, BVX_ERR_RANGE, "a number is not finite");
    return BVX_OK;
}

/* ---- loops ---- */

/* Take back a last point that repeats the first. */
static bvx_status end_table_loop(table_reader *r, const char *at)
{
    bvx_sections *const s = &r->f->sections;

    /* Loops of the library are closed without a repeated point; tables often repeat it. */
    if (s->loop_count == 0) return BVX_OK;
    bvx_section_loop *const l = &s->loops[s->loop_count - 1];
    const double *const first = s->points + 3 * l->first_point;
    const double *const last = s->points + 3 * (s->point_count - 1);
    double const x = last[0] - first[0];
    double const y = last[1] - first[1];
    double const z = last[2] - first[2];
    double const square = (x * x + y * y) + z * z;
    if (l->point_count > 1 && x == 0.0 && y == 0.0 && z == 0.0) {
        l->point_count--;
        s->point_count--;
    } else if (r->close_gap > 0.0 && square > r->close_gap * r->close_gap) {
        /* Without a limit any loop closes; with one, a gap is taken for lines that are missing. */
        return bvxi_contour_fail(
            r->f, at, BVX_ERR_FORMAT,
            "the loop that ends before this line is open: its ends lie further apart than close_gap");
    }
    return BVX_OK;
}

static bvx_status remember(table_reader *r, uint64_t **hash, uint64_t count, uint64_t *room, uint64_t value)
{
    if (count == *room) {
        uint64_t const larger = *room < 64 ? 64 : *room + *room / 2;
        BVXI_TRY(bvxi_resize(r->f->ctx, BVXI_SCRATCH, hash, *room * 8, larger * 8, "the names of loops"));
        *room = larger;
    }
    (*hash)[count] = value;
    return BVX_OK;
}

static uint64_t word_hash(table_word w, uint64_t seed)
{
    return bvx_hash(w.at, w.size, seed);
}

/* A bvxi_key_fn. */
static void section_key(const void *user, uint64_t number, uint32_t key[BVXI_KEY_WORDS])
{
    const table_reader *const r = user;
    key[0] = (uint32_t)r->section_hash[number];
    key[1] = (uint32_t)(r->section_hash[number] >> 32);
}

static bvx_status compare_plane(table_reader *r, uint32_t section, double position, const double normal[3])
{
    const bvx_sections *const s = &r->f->sections;
    if (s->positions[section] != position)
        return bvxi_contour_fail(r->f, r->line, BVX_ERR_FORMAT,
                                 "the section has another position on an earlier line");
    for (int i = 0; i < 3 && r->planes; i++)
        if (s->normals[3 * (uint64_t)section + (uint64_t)i] != normal[i])
            return bvxi_contour_fail(r->f, r->line, BVX_ERR_FORMAT,
                                     "the section has another normal on an earlier line");
    return BVX_OK;
}

static bvx_status find_table_section(table_reader *r, double position, const double normal[3],
                                     uint32_t *section)
{
    uint64_t const next = r->f->sections.section_count, room = r->section_room;
    /* The new hash stands where the section's number would: the tree compares it with the others there. */
    BVXI_TRY(remember(r, &r->section_hash, next, &r->section_room, word_hash(r->word[TABLE_SECTION], 0)));
    if (r->sections.key == NULL)
        BVXI_TRY(bvxi_key_tree_open(r->f->ctx, &r->sections, section_key, r, r->section_room));
    else if (r->section_room > room) BVXI_TRY(bvxi_key_tree_grow(r->f->ctx, &r->sections, r->section_room));
    *section = (uint32_t)bvxi_key_tree_find(&r->sections, next);
    /* A name that is known must lie where it lay: a second position is a mistake in the table. */
    if (*section != next) return compare_plane(r, *section, position, normal);
    return r->planes ? bvxi_contour_add_plane(r->f, position, normal)
                     : bvxi_contour_add_section(r->f, position);
}

static bvx_status read_normal(table_reader *r, double normal[3])
{
    BVXI_TRY(table_number(r, TABLE_NX, "expected a number as nx", &normal[0]));
    BVXI_TRY(table_number(r, TABLE_NY, "expected a number as ny", &normal[1]));
    BVXI_TRY(table_number(r, TABLE_NZ, "expected a number as nz", &normal[2]));
    double const length = sqrt((normal[0] * normal[0] + normal[1] * normal[1]) + normal[2] * normal[2]);
    if (!(length > 0.0) || !(length < 1e300))
        return bvxi_contour_fail(r->f, r->line, BVX_ERR_FORMAT, "the plane's normal has no length");
    return BVX_OK;
}

/* 1 where the line has neither a loop nor anything of one. */
static int states_section(const table_reader *r)
{
    static const int of_loop[] = {TABLE_LOOP, TABLE_X, TABLE_Y, TABLE_LABEL, TABLE_Z};
    /* A loop may have no name, so a point without one is still a point. */
    for (size_t i = 0; i < sizeof of_loop / sizeof of_loop[0]; i++)
        if (r->column[of_loop[i]] >= 0 && (of_loop[i] != TABLE_Z || r->planes) &&
            r->word[of_loop[i]].size != 0)
            return 0;
    return 1;
}

static bvx_status read_table_line(table_reader *r, const char *p, const char *end)
{
    bvx_sections *const s = &r->f->sections;
    double position, point[3], normal[3] = {0.0, 0.0, 1.0}, label = 1.0;

    BVXI_TRY(split_table_line(r, p, end));
    BVXI_TRY(table_number(r, TABLE_POSITION, "expected a number as the position", &position));
    if (states_section(r)) {
        uint32_t section;
        if (r->planes) BVXI_TRY(read_normal(r, normal));
        return find_table_section(r, position, normal, &section);
    }
    BVXI_TRY(table_number(r, TABLE_X, "expected a number as x", &point[0]));
    BVXI_TRY(table_number(r, TABLE_Y, "expected a number as y", &point[1]));
    if (r->column[TABLE_LABEL] >= 0)
        BVXI_TRY(table_number(r, TABLE_LABEL, "expected a number as the label", &label));

    /* Compared as doubles first: a cast of what is out of range is undefined. */
    if (!(label > -2147483648.0 && label <= 2147483647.0) || label != (double)(int32_t)label)
        return bvxi_contour_fail(r->f, r->line, BVX_ERR_FORMAT, "the label is not a whole number");
    point[2] = position;
    if (r->planes) {
        BVXI_TRY(table_number(r, TABLE_Z, "expected a number as z", &point[2]));
        BVXI_TRY(read_normal(r, normal));
    }

    if (s->loop_count == 0 || !same_word(r->loop, r->word[TABLE_LOOP]) ||
        !same_word(r->section, r->word[TABLE_SECTION])) {
        uint32_t section = 0;
        BVXI_TRY(end_table_loop(r, r->line));
        BVXI_TRY(find_table_section(r, position, normal, &section));
        BVXI_TRY(remember(r, &r->loop_hash, s->loop_count, &r->loop_room,
                          word_hash(r->word[TABLE_LOOP], word_hash(r->word[TABLE_SECTION], 1))));
        BVXI_TRY(bvxi_contour_add_loop(r->f, section, (int32_t)label));
        r->loop = r->word[TABLE_LOOP];
        r->section = r->word[TABLE_SECTION];
    }

    BVXI_TRY(compare_plane(r, s->loops[s->loop_count - 1].section, position, normal));
    if (s->loops[s->loop_count - 1].label != (int32_t)label)
        return bvxi_contour_fail(r->f, r->line, BVX_ERR_FORMAT,
                                 "the loop has another label on an earlier line");
    return bvxi_contour_add_point(r->f, point);
}

bvx_status bvxi_read_contour_table(bvxi_contour_file *f, double close_gap)
{
    table_reader r = {.f = f, .close_gap = close_gap};
    int headed = 0;
    uint64_t lines = 0;

    /* The planes of a table are z = position. */
    f->sections.normal[2] = 1.0;
    if (f->end - f->p >= 3 && memcmp(f->p, "\xef\xbb\xbf", 3) == 0) f->p += 3; /* a byte order mark */
    while (f->p < f->end) {
        const char *const end = bvxi_find_byte(f->p, f->end, '\n');
        table_word const all = trim_word(f->p, end);
        r.line = f->p;
        if (all.size != 0 && *all.at != '#') {
            BVXI_TRY(headed ? read_table_line(&r, f->p, end) : read_table_head(&r, f->p, end));
            headed = 1;
        }
        f->p = end < f->end ? end + 1 : end;
        /* Every 65,536 lines: a call for each would cost more than reading it. */
        if ((++lines & 0xffff) == 0)
            BVXI_TRY(bvxi_progress(f->ctx, "read", (double)(f->p - f->begin) / (double)(f->end - f->begin)));
    }
    if (!headed) return BVXI_FILE_FAIL(f, BVX_ERR_EMPTY, "the file has no head line");

    BVXI_TRY(end_table_loop(&r, f->end));

    /* Lines of one loop must stand together: apart they would be two loops. */
    const bvx_sections *const s = &r.f->sections;
    uint64_t const n = s->loop_count;
    uint32_t *order = NULL;

    BVXI_TRY(bvxi_alloc(r.f->ctx, BVXI_SCRATCH, n * 4, "the names of loops", &order));
    /* Sorted by the hash of section and loop, equal names become neighbours. */
    for (uint64_t i = 0; i < n; i++) order[i] = (uint32_t)i;
    BVXI_TRY(bvxi_radix_sort(r.f->ctx, r.loop_hash, order, n));
    for (uint64_t i = 1; i < n; i++)
        if (r.loop_hash[i] == r.loop_hash[i - 1])
            return BVXI_FILE_FAIL(
                r.f, BVX_ERR_FORMAT,
                "loops %u and %u of the file (section at %g) have one name in one section: lines of a "
                "loop stand together",
                (uint64_t)order[i - 1], (uint64_t)order[i], s->positions[s->loops[order[i]].section]);
    return BVX_OK;
}
