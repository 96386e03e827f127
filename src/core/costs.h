/* costs.h - what works take, about: the table by which the bars of calls are planned. Not installed.
 *
 * Microseconds of one thread on the machine on which they were measured; only their ratios count, and nothing
 * but the bar goes by them. Each is right within a factor of two or so on the shared meshes; bench_progress
 * says how far a bar is off.
 *
 * Ends are the centres beside a surface: those with a neighbour across a face on the other side. Sides are
 * the faces of the lattice's box, as many as it has in voxels. */
#ifndef BVXI_COSTS_H
#define BVXI_COSTS_H

#include <stdint.h>

/* ---- Meshes: for a triangle ---- */

#define BVXI_COST_CHECK      0.06
#define BVXI_COST_CHECK_FAR  0.12 /* where it is beyond the caches */
#define BVXI_COST_CHECK_MADE 0.05 /* of a mesh that the library made: its vertices lie in order */
#define BVXI_COST_WELD       0.09 /* and what goes by welded vertices: pieces, sharp edges, patches */
#define BVXI_COST_CROSSINGS  0.55 /* a search tree and the pairs in it */
#define BVXI_COST_CROSSED    0.9  /* the same of a mesh whose parts lie in each other */
#define BVXI_COST_CRUMBS     0.06 /* small parts of its solid are told from its own */
#define BVXI_COST_OPENED     0.2  /* quadrics and the queue */
#define BVXI_COST_COLLAPSE   1.4  /* of levels: most of it goes to the first */

/* Checking a mesh. */
static inline double bvxi_cost_of_check(double triangles)
{
    double const each = BVXI_COST_CHECK + 6e-7 * triangles;

    return (each < BVXI_COST_CHECK_FAR ? each : BVXI_COST_CHECK_FAR) * triangles;
}

/* ---- Solids ---- */

#define BVXI_COST_SNAP       0.002 /* a triangle */
#define BVXI_COST_ROWS       0.01  /* a triangle */
#define BVXI_COST_ROWS_SIDE  0.012 /* a side: the rows themselves */
#define BVXI_COST_HOLES      0.03  /* a triangle: looking for open edges */
#define BVXI_COST_UNCOVERED  0.3   /* a triangle, where most run along their edges as some neighbour does */
#define BVXI_COST_HOLES_SIDE 0.3   /* a side, where there are holes, before these are known */
#define BVXI_COST_PART       0.03  /* a triangle: pieces that are sheets are told from bodies */

/* Winding numbers: a hole is asked in all the voxels that it is seen from as large, and each of them asks of
 * all others that are there. */
#define BVXI_COST_HOLE      1.0 /* the square of a hole's diagonal in voxels */
#define BVXI_COST_HOLE_PAIR 0.3 /* a hole's diagonal in voxels, for each hole */

/* The voxels that a surface touches. */
#define BVXI_COST_TOUCH      0.02 /* a triangle */
#define BVXI_COST_TOUCH_SIDE 0.05 /* a side */
#define BVXI_COST_TOUCH_AREA 0.07 /* an area in voxels' faces, where that is looked at */

/* The spaces that a surface leaves. */
#define BVXI_COST_SPACES_ROW 0.05 /* a row of voxels */
#define BVXI_COST_RIM        0.3  /* a voxel of the surface that votes outside, where cavities are filled */

/* ---- Walls too thin for the lattice ---- */

#define BVXI_COST_WALLS      0.15 /* a triangle: where they may be */
#define BVXI_COST_WALLS_SIDE 0.03 /* a side */
#define BVXI_COST_ASK        3.0  /* a place that may lie in one */
#define BVXI_COST_WIDEN      6.0  /* a voxel that one has lost */
#define BVXI_COST_WIDEN_FEW  15.0 /* and beside each of the first few */
#define BVXI_MENDS_OF_WALLS  2.0
#define BVXI_COST_FLATTEN    4.5  /* a centre beside one, in the surface; twice as much in a sharp one */
#define BVXI_COST_FLAT_MESH  0.04 /* a triangle, where there is any such centre; twice as much too */
#define BVXI_COST_MAYBE_THIN 0.3  /* an end, before walls have been looked for: of most bodies none is thin */

#define BVXI_CENTRES_OF_WALL 4.0 /* so many are beside a voxel that is lost */

/* Marking the places where they may be. */
static inline double bvxi_cost_of_marks(double triangles, double sides)
{
    return 0.4 * BVXI_COST_WALLS * triangles + BVXI_COST_WALLS_SIDE * sides;
}

/* Where few walls are thin, each costs what lies around it; where many are, they share that. Then places are
 * marked anew, some times. */
static inline double bvxi_cost_of_widening(double voxels, double triangles, double sides)
{
    double const few = 200.0;

    if (!(voxels > 0.0)) return 0.0;
    return BVXI_COST_WIDEN * voxels + BVXI_COST_WIDEN_FEW * (voxels < few ? voxels : few) +
           BVXI_MENDS_OF_WALLS * bvxi_cost_of_marks(triangles, sides);
}

/* ---- Surfaces: for an end ---- */

#define BVXI_COST_MEASURE      0.1 /* its closest point */
#define BVXI_COST_MEASURE_MESH 0.1 /* a triangle: the search tree for these */
#define BVXI_COST_MARCH        0.03
#define BVXI_COST_CUTS         0.055
#define BVXI_COST_SHARP_CUTS   0.12
#define BVXI_COST_SHARP_MESH   0.06 /* a triangle, whose plane is asked */
#define BVXI_COST_SHARPEN      0.03
#define BVXI_COST_SHARP_CELL   2.0 /* a cell with a sharp edge or corner */
#define BVXI_COST_CLEAN        0.016
#define BVXI_COST_SAMPLE       3.0 /* a point, of all that a repair measures at */

#define BVXI_COST_VALUE 0.17 /* a value of a field's band */

#define BVXI_BAND_OF_SIDE     0.8 /* values of a band on each side of the surface, for a voxel of its width */
#define BVXI_TRIANGLES_OF_END 1.4 /* about so many triangles has the surface */
#define BVXI_SHARP_OF_END     0.03 /* and so many sharp cells, where they are looked for */
#define BVXI_SHARP_OF_TURNS \
    1.2 /* of ends whose triangle is turned far from the next one's so many have one */
#define BVXI_SHARP_OF_FIELD 0.08 /* the same of a field alone, whose surface is made because it is sharp */
#define BVXI_ENDS_OF_AREA   1.7  /* of an area in voxels' faces there are so many ends */
#define BVXI_ENDS_OF_SIDE   1.8  /* where the area is not known */

/* The surface between ends, cut where the mesh of so many triangles says. */
static inline double bvxi_cost_of_surface(double ends, double triangles, int sharp)
{
    double const plain = BVXI_COST_MARCH * ends;

    if (!sharp) return plain + BVXI_COST_CUTS * ends;
    return plain + BVXI_COST_SHARP_CUTS * ends + BVXI_COST_SHARP_MESH * triangles +
           (BVXI_COST_SHARPEN + BVXI_COST_SHARP_CELL * BVXI_SHARP_OF_END) * ends;
}

/* ---- Sections ---- */

#define BVXI_COST_PLANES     0.07  /* a contour's point: planes, and their lines on the grid */
#define BVXI_COST_MEND       0.1   /* a contour's point */
#define BVXI_COST_BODY       1.3   /* a contour's point: all of the surface, before it is cut by the grid */
#define BVXI_COST_SLAB_RINGS 0.7   /* a contour's point, or where it meets a line of the grid: the slabs */
#define BVXI_COST_SLAB       0.075 /* a triangle that a slab has room for */
#define BVXI_COST_SLAB_AGAIN 0.12  /* the same, where the room was not enough */
#define BVXI_LEVELS_OF_SLABS 0.4   /* looking for levels that cross, of what the slabs cost */

/* The sides of a lattice's box. */
static inline double bvxi_sides_of(const int32_t n[3])
{
    return (double)n[0] * n[1] + (double)n[1] * n[2] + (double)n[2] * n[0];
}

#endif
