/* string.h - what the core takes from the C library, for the compile check with clang's MSVC target. */
#ifndef CHECK_MSVC_STRING_H
#define CHECK_MSVC_STRING_H
#include <stddef.h>
void *memcpy(void *to, const void *from, size_t size);
void *memmove(void *to, const void *from, size_t size);
void *memset(void *block, int value, size_t size);
int memcmp(const void *a, const void *b, size_t size);
#endif
