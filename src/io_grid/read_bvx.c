/* read_bvx.c - a grid from our own format; the layout stands in bvx_file.h.
 *
 * The head and the heads of all slices are checked first, then the slices that are wanted (checksum, lengths
 * of runs, bits past the rows), and only then is there a grid to fill. So a damaged file allocates nothing
 * but the places of its slices. Slices outside the window are passed by their byte counts. Checking and
 * filling run in parallel over slices; the first slice in the file that is wrong is the one reported,
 * whatever the threads. */
#include "io_grid/bvx_file.h"
#include "io_grid/tree_file.h"

enum { BVX_SLICE_GOOD = 0, BVX_SLICE_CHECKSUM, BVX_SLICE_RUN, BVX_SLICE_TOTAL, BVX_SLICE_PADDING };

typedef struct bvx_wrong {
    int32_t slice, why;
} bvx_wrong;

typedef struct bvx_unpacking {
    const bvxi_grid_source *source;
    bvx_lattice lattice;
    bvx_window window;    /* of the file */
    bvx_window part;      /* what is wanted, counted from the file's first voxel */
    uint64_t frame;       /* seed of the checksums */
    uint64_t raw;         /* bytes of a slice as words */
    uint64_t *place;      /* where each wanted slice starts */
    int32_t first, count; /* the wanted slices */
    int32_t pieces;
    bvx_grid *grid;
    bvx_wrong wrong[BVXI_MOST_PIECES]; /* the first wrong slice of each piece */
} bvx_unpacking;

/* ---- head ---- */

/* What files of grids and of octrees differ in. */
static const struct {
    uint8_t magic[8]; /* the first 4 say what it is, the last 4 that it came through whole */
    const char *other, *start, *name;
    uint32_t reserved; /* bytes from here to the checksum */
} bvx_kinds[] = {{{0x89, 'B', 'V', 'X', 0x0d, 0x0a, 0x1a, 0x0a},
                  "byte 3: the file holds a grid, no octree: bvx_read_grid reads it",
                  "byte 0: the file does not begin as .bvx files do (89 42 56 58 0d 0a 1a 0a)",
                  "file",
                  BVXI_BVX_AT_RESERVED},
                 {{0x89, 'B', 'V', 'O', 0x0d, 0x0a, 0x1a, 0x0a},
                  "byte 3: the file holds an octree, no grid: bvx_read_octree reads it",
                  "byte 0: the file does not begin as .bvx files of octrees do (89 42 56 4f 0d 0a 1a 0a)",
                  "octree",
                  BVXI_TREE_AT_RESERVED}};

static bvx_status bvx_check_start(const bvxi_grid_source *source, int kind)
{
    const uint8_t *const magic = bvx_kinds[kind].magic, *const head = source->begin;
    uint64_t const size = (uint64_t)(source->end - head);

    if (size >= 4 && memcmp(head, bvx_kinds[!kind].magic, 4) == 0)
        return BVXI_FILE_FAIL(source, BVX_ERR_FORMAT, "%s", bvx_kinds[!kind].other);
    if (size < 8 || memcmp(head, magic, 4) != 0)
        return BVXI_FILE_FAIL(source, BVX_ERR_FORMAT, "%s", bvx_kinds[kind].start);
    if (memcmp(head, magic, 8) != 0)
        return BVXI_FILE_FAIL(source, BVX_ERR_FORMAT,
                              "bytes 4 to 7 are not 0d 0a 1a 0a: a transfer took the file for text");
    if (size < BVXI_BVX_AT_VERSION + 4)
        return BVXI_FILE_FAIL(source, BVX_ERR_FORMAT, "byte %u: the file ends in its head", size);
    if (bvxi_load_u32(head + BVXI_BVX_AT_VERSION, 0) > BVXI_BVX_VERSION)
        return BVXI_FILE_FAIL(source, BVX_ERR_UNSUPPORTED,
                              "the %s is of version %u, this library reads version %u", bvx_kinds[kind].name,
                              (uint64_t)bvxi_load_u32(head + BVXI_BVX_AT_VERSION, 0),
                              (uint64_t)BVXI_BVX_VERSION);
    if (size < BVXI_BVX_HEAD)
        return BVXI_FILE_FAIL(source, BVX_ERR_FORMAT, "byte %u: the file ends in its head of %u bytes", size,
                              (uint64_t)BVXI_BVX_HEAD);

    /* From here on the head is as it was written; what is wrong now is the writer's. */
    if (bvxi_load_u64(head + BVXI_BVX_AT_CHECK, 0) != bvx_hash(head, BVXI_BVX_AT_CHECK, 0))
        return BVXI_FILE_FAIL(source, BVX_ERR_FORMAT,
                              "bytes 0 to %u: the head is damaged, its checksum differs",
                              (uint64_t)BVXI_BVX_HEAD - 1);
    if (bvxi_load_u32(head + BVXI_BVX_AT_VERSION, 0) != BVXI_BVX_VERSION)
        return BVXI_FILE_FAIL(source, BVX_ERR_FORMAT, "byte %u: there is no version 0",
                              (uint64_t)BVXI_BVX_AT_VERSION);
    if (bvxi_load_u32(head + BVXI_BVX_AT_HEAD_SIZE, 0) != BVXI_BVX_HEAD)
        return BVXI_FILE_FAIL(source, BVX_ERR_FORMAT, "byte %u: a head of %u bytes; version %u has %u",
                              (uint64_t)BVXI_BVX_AT_HEAD_SIZE,
                              (uint64_t)bvxi_load_u32(head + BVXI_BVX_AT_HEAD_SIZE, 0),
                              (uint64_t)BVXI_BVX_VERSION, (uint64_t)BVXI_BVX_HEAD);
    /* Reserved bytes may get a meaning in a later version, which this one would misread. */
    for (uint32_t i = bvx_kinds[kind].reserved; i < BVXI_BVX_AT_CHECK; i++)
        if (head[i] != 0)
            return BVXI_FILE_FAIL(source, BVX_ERR_FORMAT, "byte %u: a reserved byte is not 0", (uint64_t)i);
    return BVX_OK;
}

bvx_status bvxi_bvx_take_start(const bvxi_grid_source *source, int kind, bvx_lattice *lattice)
{
    const uint8_t *const head = source->begin;
    BVXI_TRY(bvx_check_start(source, kind));
    for (int32_t a = 0; a < 3; a++) {
        lattice->origin[a] = bvxi_load_f64(head + BVXI_BVX_AT_ORIGIN + 8 * a, 0);
        lattice->spacing[a] = bvxi_load_f64(head + BVXI_BVX_AT_SPACING + 8 * a, 0);
        lattice->dims[a] = bvxi_load_side(head + BVXI_BVX_AT_DIMS + 4 * a);
    }
    lattice->fraction_bits = bvxi_load_side(head + BVXI_BVX_AT_FRACTION);
    return BVX_OK;
}

void bvxi_bvx_put_start(uint8_t *head, int kind, const bvx_lattice *lattice, const int32_t sides[3])
{
    memset(head, 0, BVXI_BVX_HEAD);
    memcpy(head, bvx_kinds[kind].magic, 8);
    bvxi_store_u32(head + BVXI_BVX_AT_VERSION, BVXI_BVX_VERSION);
    bvxi_store_u32(head + BVXI_BVX_AT_HEAD_SIZE, BVXI_BVX_HEAD);
    for (int32_t a = 0; a < 3; a++) {
        bvxi_store_f64(head + BVXI_BVX_AT_ORIGIN + 8 * a, lattice->origin[a]);
        bvxi_store_f64(head + BVXI_BVX_AT_SPACING + 8 * a, lattice->spacing[a]);
        bvxi_store_u32(head + BVXI_BVX_AT_DIMS + 4 * a, (uint32_t)sides[a]);
    }
    bvxi_store_u32(head + BVXI_BVX_AT_FRACTION, (uint32_t)lattice->fraction_bits);
}

static bvx_status bvx_take_head(bvx_unpacking *job)
{
    const uint8_t *const head = job->source->begin;
    bvx_window *const w = &job->window;

    BVXI_TRY(bvxi_bvx_take_start(job->source, BVXI_BVX_GRID, &job->lattice));

    /* The head's fields of x and y stand side by side; those of z stand apart. */
    for (int32_t a = 0; a < 3; a++) {
        w->low[a] = bvxi_load_side(head + (a < 2 ? BVXI_BVX_AT_LOW + 4 * a : BVXI_BVX_AT_Z));
        w->size[a] = bvxi_load_side(head + (a < 2 ? BVXI_BVX_AT_SIZE + 4 * a : BVXI_BVX_AT_Z + 4));
    }
    bvx_status const status = bvxi_lattice_check(job->source->ctx, "BVX", &job->lattice);
    /* the argument at fault is the file */
    if (status != BVX_OK) return status == BVX_ERR_RANGE ? BVX_ERR_RANGE : BVX_ERR_FORMAT;

    /* Compared by differences, as sums of damaged numbers might overflow. */
    for (int32_t a = 0; a < 3; a++)
        if (w->size[a] < 1 || w->low[a] < 0 || w->size[a] > job->lattice.dims[a] ||
            w->low[a] > job->lattice.dims[a] - w->size[a])
            return BVXI_FILE_FAIL(job->source, BVX_ERR_FORMAT,
                                  "the window has %d voxels from %d on along %s, the lattice has %d",
                                  (int64_t)w->size[a], (int64_t)w->low[a], bvxi_axis_name[a],
                                  (int64_t)job->lattice.dims[a]);
    job->frame = bvxi_bvx_frame(head);
    job->raw = (uint64_t)w->size[1] * (uint64_t)bvxi_row_words(w->size[0]) * 8;
    return BVX_OK;
}

/* ---- the slices' places ---- */

static bvx_status bvx_check_slice_head(const bvx_unpacking *job, const uint8_t *p, int32_t k)
{
    uint64_t const left = (uint64_t)(job->source->end - p), at = (uint64_t)(p - job->source->begin);
    int64_t const z = (int64_t)job->window.low[2] + k;

    if (left < BVXI_BVX_SLICE_HEAD)
        return BVXI_FILE_FAIL(job->source, BVX_ERR_FORMAT, "byte %u: the file ends before slice z %d",
                              at + left, z);
    /* Slices stand in order and name their z: a lost one is found at the next. */
    if (bvxi_load_u32(p + 8, 0) != (uint32_t)z)
        return BVXI_FILE_FAIL(job->source, BVX_ERR_FORMAT, "byte %u: slice z %u in place of z %d", at + 8,
                              (uint64_t)bvxi_load_u32(p + 8, 0), z);
    if (bvxi_load_u32(p + 12, 0) > BVXI_BVX_RUNS)
        return BVXI_FILE_FAIL(job->source, BVX_ERR_FORMAT,
                              "byte %u: slice z %d has encoding %u; there are 0 and 1", at + 12, z,
                              (uint64_t)bvxi_load_u32(p + 12, 0));

    /* The length is all that finds the next slice, so it must stay inside the file. */
    uint64_t const n = bvxi_load_u64(p + 16, 0);
    if (n > left - BVXI_BVX_SLICE_HEAD)
        return BVXI_FILE_FAIL(job->source, BVX_ERR_FORMAT,
                              "byte %u: slice z %d has %u bytes, the file has %u more", at + 16, z, n,
                              left - BVXI_BVX_SLICE_HEAD);
    /* Words have one length; runs are checked for theirs when they are decoded. */
    if (bvxi_load_u32(p + 12, 0) == BVXI_BVX_RAW && n != job->raw)
        return BVXI_FILE_FAIL(job->source, BVX_ERR_FORMAT,
                              "byte %u: slice z %d has %u bytes, its words are %u", at + 16, z, n, job->raw);
    return BVX_OK;
}

/* ---- slices checked ---- */

/* One length of a run; NULL when it is cut, has more than 8 bytes or more than it needs. */
static inline const uint8_t *bvx_take_length(const uint8_t *p, const uint8_t *end, uint64_t *length)
{
    /* Seven bits a byte, the lowest first; the top bit says that another byte follows. */
    if (p == end) return NULL;
    uint64_t v = *p++;
    *length = v;
    if (v < 128) return p;
    v &= 127;
    for (int32_t shift = 7; shift < 56 && p != end; shift += 7) {
        uint64_t const b = *p++;
        v |= (b & 127) << shift;
        *length = v;
        /* A last byte of 0 would be a longer way to write the same length; one number has one form. */
        if (b < 128) return b != 0 ? p : NULL;
    }
    return NULL;
}

static int32_t bvx_check_runs(const uint8_t *p, const uint8_t *end, uint64_t voxels)
{
    uint64_t length;
    for (int32_t nth = 0; p != end; nth |= 1) {
        p = bvx_take_length(p, end, &length);
        /* The first run may be empty, when a slice begins with a set voxel; later ones may not. */
        if (p == NULL || (length == 0 && nth != 0)) return BVX_SLICE_RUN;
        if (length > voxels) return BVX_SLICE_TOTAL;
        voxels -= length;
    }
    return voxels == 0 ? BVX_SLICE_GOOD : BVX_SLICE_TOTAL;
}

static int32_t bvx_check_slice(const bvx_unpacking *job, const uint8_t *p)
{
    uint64_t const n = bvxi_load_u64(p + 16, 0), row = (uint64_t)bvxi_row_words(job->window.size[0]) * 8;
    uint64_t const beyond = ~bvxi_tail_mask(job->window.size[0]);
    /* Checksum first: a message about a run would mislead where the bytes were damaged. */
    if (bvxi_load_u64(p, 0) != bvxi_bvx_slice_check(p, n, job->frame)) return BVX_SLICE_CHECKSUM;
    if (bvxi_load_u32(p + 12, 0) == BVXI_BVX_RUNS)
        return bvx_check_runs(p + BVXI_BVX_SLICE_HEAD, p + BVXI_BVX_SLICE_HEAD + n,
                              (uint64_t)job->window.size[0] * (uint64_t)job->window.size[1]);
    if (beyond == 0) return BVX_SLICE_GOOD;
    for (uint64_t last = row - 8; last < n; last += row)
        if ((bvxi_load_u64(p + BVXI_BVX_SLICE_HEAD + last, 0) & beyond) != 0) return BVX_SLICE_PADDING;
    return BVX_SLICE_GOOD;
}

static void bvx_check_piece(void *user, int32_t piece, uint64_t k, uint64_t end)
{
    bvx_unpacking *const job = user;
    /* A piece stops at its first wrong slice; the first of all pieces is the one reported. */
    for (; k < end && job->wrong[piece].why == BVX_SLICE_GOOD; k++) {
        job->wrong[piece].why = bvx_check_slice(job, job->source->begin + job->place[k]);
        job->wrong[piece].slice = (int32_t)k;
    }
}

static bvx_status bvx_check_slices(bvx_unpacking *job)
{
    static const char *const words[] = {
        "", "the slice is damaged, or of another lattice or window: its checksum differs",
        "a length of a run is cut, longer than it needs to be, or 0 in the middle",
        "the runs do not add up to the slice", "bits are set past the end of a row"};

    /* Pieces are looked at in the order of the file, so that the message does not depend on the workers. */
    BVXI_TRY(bvxi_for_pieces(job->source->ctx, "read", 0.0, 0.5, job->pieces, (uint64_t)job->count,
                             bvx_check_piece, job));
    for (int32_t i = 0; i < job->pieces; i++)
        if (job->wrong[i].why != BVX_SLICE_GOOD)
            return BVXI_FILE_FAIL(
                job->source, BVX_ERR_FORMAT, "byte %u: slice z %d: %s", job->place[job->wrong[i].slice],
                (int64_t)job->window.low[2] + job->first + job->wrong[i].slice, words[job->wrong[i].why]);
    return BVX_OK;
}

/* ---- slices filled in ---- */

static uint64_t *bvx_part_row(const bvx_unpacking *job, int32_t slice, int64_t y)
{
    return job->grid->words +
           ((uint64_t)slice * (uint64_t)job->part.size[1] + (uint64_t)y) * (uint64_t)job->grid->words_per_row;
}

/* Set what the part has of a run that starts at voxel x of row y. */
static void bvx_place_run(const bvx_unpacking *job, int32_t slice, int64_t x, int64_t y, int64_t length)
{
    const bvx_window *const part = &job->part;
    /* A run may go over several rows: first and last are cut to the run, those between are whole. */
    int64_t const nx = job->window.size[0], last = y + (x + length > nx ? (x + length - 1) / nx : 0);
    int64_t const end_x = x + length - (last - y) * nx; /* in the last row */
    int64_t const high = (int64_t)part->low[1] + part->size[1] - 1;
    for (int64_t row = y > part->low[1] ? y : part->low[1]; row <= last && row <= high; row++) {
        int64_t begin = (row == y ? x : 0) - part->low[0], end = (row == last ? end_x : nx) - part->low[0];
        if (begin < 0) begin = 0;
        if (end > part->size[0]) end = part->size[0];
        if (begin < end)
            bvxi_set_run(bvx_part_row(job, slice, row - part->low[1]), (int32_t)begin, (int32_t)end);
    }
}

static void bvx_fill_from_runs(const bvx_unpacking *job, int32_t slice, const uint8_t *p, const uint8_t *end)
{
    int64_t const nx = job->window.size[0];
    int64_t x = 0, y = 0;

    for (int set = 0; p != end; set = !set) {
        uint64_t length = 0;
        p = bvx_take_length(p, end, &length);
        if (set) bvx_place_run(job, slice, x, y, (int64_t)length);
        x += (int64_t)length;
        /* Short runs are the rule, and a subtraction is far cheaper than a division. */
        if (x >= 2 * nx) {
            y += x / nx;
            x %= nx;
        } else if (x >= nx) {
            y++;
            x -= nx;
        }
    }
}

static void bvx_fill_from_words(const bvx_unpacking *job, int32_t slice, const uint8_t *p)
{
    const bvx_window *const part = &job->part;
    int64_t const row_words = bvxi_row_words(job->window.size[0]), first = part->low[0] >> 6;
    int32_t const shift = part->low[0] & 63, words = job->grid->words_per_row;

    for (int32_t y = 0; y < part->size[1]; y++) {
        /* Rows of the file and of the part begin at different bits: words join two of the file's. */
        const uint8_t *const from = p +
                                    ((uint64_t)(part->low[1] + y) * (uint64_t)row_words + (uint64_t)first) *
                                        8;
        uint64_t *const to = bvx_part_row(job, slice, y);
        for (int32_t i = 0; i < words; i++) {
            uint64_t w = bvxi_load_u64(from + 8 * (size_t)i, 0) >> shift;
            /* The word after the last of a row is not read: it is another row's, or past the end. */
            if (shift != 0 && first + i + 1 < row_words)
                w |= bvxi_load_u64(from + 8 * (size_t)i + 8, 0) << (64 - shift);
            to[i] = w;
        }
        to[words - 1] &= bvxi_tail_mask(part->size[0]);
    }
}

static void bvx_fill_piece(void *user, uint64_t k, uint64_t end)
{
    const bvx_unpacking *const job = user;
    for (; k < end; k++) {
        const uint8_t *const p = job->source->begin + job->place[k], *const bytes = p + BVXI_BVX_SLICE_HEAD;
        /* All was checked before, so filling has no error to report. */
        if (bvxi_load_u32(p + 12, 0) == BVXI_BVX_RAW) bvx_fill_from_words(job, (int32_t)k, bytes);
        else bvx_fill_from_runs(job, (int32_t)k, bytes, bytes + bvxi_load_u64(p + 16, 0));
    }
}

bvx_status bvxi_read_bvx(const bvxi_grid_source *source, bvx_grid *grid)
{
    uint64_t const least = BVXI_BVX_SLICE_HEAD + 1, size = (uint64_t)(source->end - source->begin);

    bvx_unpacking job = {.source = source};
    BVXI_TRY(bvx_take_head(&job));

    /* A slice takes at least its head and a byte, so counts cannot allocate more than the file. */
    if ((size - BVXI_BVX_HEAD) / least < (uint64_t)job.window.size[2])
        return BVXI_FILE_FAIL(source, BVX_ERR_FORMAT, "%u bytes cannot hold %d slices", size,
                              (int64_t)job.window.size[2]);
    /* Slices outside the window are stepped over: only their heads are checked. A window that is not inside the file
     * is refused when the grid is made. */
    const bvx_window *const w = source->window;
    int32_t const slices = job.window.size[2];
    int const whole = w == NULL || w->size[2] < 1 || w->low[2] < 0 || w->low[2] > slices - 1 ||
                      w->size[2] > slices - w->low[2];
    job.first = whole ? 0 : w->low[2];
    job.count = whole ? slices : w->size[2];
    job.pieces = bvxi_piece_count(job.raw < 65536 ? job.raw * (uint64_t)job.count : UINT64_MAX, 65536);
    if (job.pieces > job.count) job.pieces = job.count;
    BVXI_TRY(BVXI_ARRAY(source->ctx, job.count, "the places of slices", job.place));
    const uint8_t *p = source->begin + BVXI_BVX_HEAD;
    for (int32_t k = 0; k < slices; k++) {
        /* Every head is checked, also of slices that are not wanted: the one after must be found. */
        BVXI_TRY(bvx_check_slice_head(&job, p, k));
        if (k >= job.first && k < job.first + job.count)
            job.place[k - job.first] = (uint64_t)(p - source->begin);
        p += BVXI_BVX_SLICE_HEAD + bvxi_load_u64(p + 16, 0);
    }
    if (p != source->end)
        return BVXI_FILE_FAIL(source, BVX_ERR_FORMAT, "byte %u: %u bytes after the last slice",
                              (uint64_t)(p - source->begin), (uint64_t)(source->end - p));
    BVXI_TRY(bvx_check_slices(&job));
    BVXI_TRY(bvxi_open_file_grid(source, &job.lattice, &job.window, &job.part, grid));
    job.grid = grid;
    return bvxi_for_ranges(job.source->ctx, "read", 0.5, 1.0, job.pieces, (uint64_t)job.count, bvx_fill_piece,
                           &job);
}
