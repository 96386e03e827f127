/* command_list.c - the commands, in the order of the help. */
#include "cli_commands/commands.h"

const cli_command *const cli_commands[CLI_COMMANDS + 1] = {
    &cli_lod,   &cli_simplify, &cli_info,       &cli_check,   &cli_voxelize, &cli_repair, &cli_hull,
    &cli_fill,  &cli_morph,    &cli_components, &cli_refine,  &cli_sections, &cli_slice,  &cli_boolean,
    &cli_faces, &cli_labels,   &cli_convert,    &cli_compare, &cli_render,   NULL};
