/* read_limits.h - what readers may take for a file of so many bytes, the
 * result included, as bitvox.h says at each of them. Grids, and volumes that
 * were packed by gzip, come on top: they may be far larger than their files. */
#ifndef TEST_READ_LIMITS_H
#define TEST_READ_LIMITS_H

#include <stdint.h>

enum {
    /* at most a corner of a polygon for one or two bytes */
    READ_STL = 8,
    READ_OBJ = 64,
    READ_PLY = 128,
    READ_OFF = 64,
    READ_GLTF = 4096, /* nodes repeat meshes, accessors without bytes are zeros */
    READ_3MF = 8192,  /* it is packed, and components repeat objects */
    READ_POINTS = 16,
    READ_SECTIONS = 40,
    READ_OCTREE = 2,
    READ_VOLUME = 4,
    READ_GRID = 1,
    READ_VOX = 4,          /* nodes of a scene with their places */
    READ_TABLES = 1 << 15, /* that are there for the smallest file too */
    /* 1032 to 1 is the most that deflate can do; and once more, twice as large, where samples are turned */
    READ_GZIP = 3300
};

static inline uint64_t read_limit(int32_t multiple, uint64_t size)
{
    return (uint64_t)multiple * size + READ_TABLES;
}

#endif
