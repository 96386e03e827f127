/* models_3mf.h - the models in the container of a 3MF file. Not installed. */
#ifndef BVXI_MODELS_3MF_H
#define BVXI_MODELS_3MF_H

#include "io/formats.h"

typedef struct bvxi_model {
    const uint8_t *entry, *text; /* in the directory, with its name at 46; the bytes */
    uint64_t name, packed, size;
} bvxi_model;

typedef struct bvxi_models {
    bvxi_model *model; /* as in the directory, 3D/3dmodel.model last */
    uint16_t *order;   /* their numbers by their names */
    uint64_t count;
} bvxi_models;

/* Unpacked; the arrays are scratch. */
bvx_status bvxi_models_open(const bvxi_source *source, const bvx_read_options *options, bvxi_models *models);

/* The number of the first model with a path from the container's root; count: there is none. */
uint64_t bvxi_models_find(const bvxi_models *models, const char *path, uint64_t size);

#endif
