/* status.c - statuses and reasons, their texts, and the version. */
#include "core.h"

const char *bvx_status_text(bvx_status status)
{
    switch (status) {
#define BVXI_STATUS_TEXT(name, value, text) \
    case value: return text;
        BVX_STATUS_LIST(BVXI_STATUS_TEXT)
#undef BVXI_STATUS_TEXT
    default: return "unknown status";
    }
}

const char *bvx_reason_text(int32_t reason)
{
    switch (reason) {
#define BVXI_REASON_TEXT(name, value, text) \
    case value: return text;
        BVX_REASON_LIST(BVXI_REASON_TEXT)
#undef BVXI_REASON_TEXT
    default: return "unknown reason";
    }
}

int32_t bvx_version(void)
{
    return BVX_VERSION;
}
