/* touch_rows.h - the exact runs of voxels that one triangle of any size touches. Not installed. */
#ifndef BVXI_TOUCH_ROWS_H
#define BVXI_TOUCH_ROWS_H

#include "touch/surface_voxels.h"

/* Hand the runs within the tile's rows and the window to bvxi_touch_run.
 * Corners are relative to the window's low corner. */
void bvxi_touch_rows(bvxi_surface_tile *tile, const int32_t (*corner)[3], uint32_t triangle);

#endif
