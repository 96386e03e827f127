/* stdlib.h - the same for the heap. */
#ifndef CHECK_MSVC_STDLIB_H
#define CHECK_MSVC_STDLIB_H
#include <stddef.h>
void *malloc(size_t size);
void free(void *block);
#endif
