/* nrrd_head.h - the header of an NRRD file, taken apart; nrrd_head.c fills it, nrrd.c uses it. Not
 * installed. */
#ifndef BVXI_NRRD_HEAD_H
#define BVXI_NRRD_HEAD_H

#include "io/formats.h"
#include "io_grid/grid_formats.h"

enum nrrd_encoding { NRRD_NONE = 0, NRRD_RAW, NRRD_TEXT, NRRD_GZIP };
enum nrrd_has {
    NRRD_HAS_SPACING = 1,
    NRRD_HAS_MIN = 2,
    NRRD_HAS_MAX = 4,
    NRRD_HAS_DIRECTION = 8,
    NRRD_HAS_ORIGIN = 16,
    NRRD_HAS_CORNER = 32
};

typedef struct nrrd_head {
    bvxi_source source; /* for messages: the whole file */
    /* after the blank line; NULL where there is none, as a detached head may have it */
    const char *data;
    const char *encoding_at;       /* where the word stands, for messages */
    const char *files, *files_end; /* the data files' field; NULL: the samples follow the head */
    const char *list, *list_end;   /* LIST: the lines of names */
    uint64_t sizes[3];
    double spacing[3], min[3], max[3], direction[3], origin[3], corner[3];
    int64_t line_skip, byte_skip;
    int32_t kind, encoding, big;
    int8_t has_sizes, has_dimension, has_endian, node[3];
    int32_t has;   /* NRRD_HAS_... */
    uint64_t seen; /* fields by number: each comes once */
} nrrd_head;

/* The fields up to the blank line; the head's source is set, all else 0. */
bvx_status bvxi_nrrd_head_read(nrrd_head *h);

/* What stands after a field's colon. */
typedef struct nrrd_value {
    const char *p, *end;
} nrrd_value;

bvx_status bvxi_nrrd_unsupported(const nrrd_head *h, int32_t reason, const char *at, const char *why);

/* How many data files a detached head names, and the name of one: [*name, *name + *length) with number in
 * place of its "%d" where pattern is not 0 (digits wide, filled with zeros when negative). */
typedef struct nrrd_file_name {
    const char *name;
    size_t length, place, rest; /* place: bytes before the "%...d", rest: where what follows it begins */
    int64_t number;
    int32_t digits, zeros, pattern;
} nrrd_file_name;
bvx_status bvxi_nrrd_data_file(const nrrd_head *h, uint64_t index, nrrd_file_name *file, uint64_t *count);

/* The line at p ends at *end; returns where the next begins, NULL when there is none. */
const char *bvxi_nrrd_line(const char *p, const char *file_end, const char **end);

#endif
