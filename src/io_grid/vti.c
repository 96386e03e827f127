/* vti.c - VTK's XML image data: where the samples of one array stand.
 *
 * Source: VTK File Formats (docs.vtk.org), versions 0.1, 1.0 and 2.x; compressed by zlib where the caller unpacks. Of several arrays
 * the one that is the active scalars is read, of cells before points; where none is active, the first with
 * one number each. Cells are voxels. Points are voxels' centres, so there is one more along each axis and the
 * corner is half a voxel lower.
 * Guarantee: counts are held against the file's bytes before anything is made. */
#include "io_grid/grid_formats.h"

enum vti_format { VTI_ASCII = 1, VTI_BINARY, VTI_APPENDED };
enum vti_rank { VTI_CELLS_ACTIVE = 0, VTI_POINTS_ACTIVE, VTI_CELLS_FIRST, VTI_POINTS_FIRST, VTI_NO_ARRAY };

typedef struct vti_array {
    const char *tag, *text; /* its '<', and what stands after the tag */
    uint64_t offset;        /* of appended data */
    int32_t rank, kind, format;
} vti_array;

typedef struct vti_file {
    bvxi_xml xml;
    int64_t extent[6]; /* of the piece, in points */
    double origin[3], spacing[3];
    vti_array array;          /* the best so far */
    bvxi_xml_text active;     /* name of the section's active scalars */
    const char *appended;     /* after the underscore */
    int32_t big, header_size; /* bytes of a count before data */
    int8_t compressed, unpacks, has_active, has_image, has_piece, appended_base64;
} vti_file;

static BVXI_COLD bvx_status vti_fail(const vti_file *f, bvx_status status, const char *at, const char *why)
{
    return BVXI_LINE_FAIL(&f->xml.source, at, status, "%s", why);
}

static bvx_status vti_take_doubles(const vti_file *f, bvxi_xml_text value, int n, double *numbers)
{
    for (int i = 0; i < n; i++) {
        value.p = bvxi_skip_space(value.p, value.end);
        size_t const used = bvxi_parse_double(value.p, value.end, &numbers[i]);
        /* The number must end where a word does: 1.5mm is no number of the file. */
        if (used == 0 || (value.p + used < value.end && !bvxi_is_space(value.p[used])))
            return bvxi_fail_expected(&f->xml.source, value.p, "a number");
        value.p += used;
    }
    value.p = bvxi_skip_space(value.p, value.end);
    return value.p == value.end ? BVX_OK : bvxi_fail_expected(&f->xml.source, value.p, "no further number");
}

static bvx_status vti_take_extent(const vti_file *f, const char *name, int64_t extent[6])
{
    bvxi_xml_text value;
    double v[6];

    if (!bvxi_xml_attribute(&f->xml, name, &value))
        return BVXI_LINE_FAIL(&f->xml.source, f->xml.tag, BVX_ERR_FORMAT, "the element has no %s", name);
    BVXI_TRY(vti_take_doubles(f, value, 6, v));
    for (int i = 0; i < 6; i++) {
        /* Read as doubles, as 3.0 is written too; compared before the cast, which is undefined outside. */
        if (!(v[i] >= -2147483648.0 && v[i] <= 2147483647.0) || v[i] != (double)(int64_t)v[i])
            return bvxi_fail_expected(&f->xml.source, value.p, "whole numbers from -2^31 to 2^31 - 1");
        extent[i] = (int64_t)v[i];
    }
    return BVX_OK;
}

static bvx_status vti_take_count(const vti_file *f, bvxi_xml_text value, uint64_t *count)
{
    uint64_t n = 0;
    const char *p = value.p;
    for (; p < value.end && *p >= '0' && *p <= '9'; p++)
        if (n < UINT64_MAX / 16) n = n * 10 + (uint64_t)(*p - '0'); /* too many digits stay too large */
    if (p == value.p || p != value.end) return bvxi_fail_expected(&f->xml.source, value.p, "a whole number");
    *count = n;
    return BVX_OK;
}

/* ---- elements ---- */

static bvx_status vti_take_file(vti_file *f)
{
    bvxi_xml_text v;

    if (!bvxi_xml_attribute(&f->xml, "type", &v) || !bvxi_xml_is(v, "ImageData"))
        return vti_fail(f, BVX_ERR_UNSUPPORTED, f->xml.tag, "the file's type is not ImageData");
    if (!bvxi_xml_attribute(&f->xml, "version", &v) || !(bvxi_xml_is(v, "0.1") || bvxi_xml_is(v, "1.0") ||
                                                         (v.end - v.p > 2 && v.p[0] == '2' && v.p[1] == '.')))
        return vti_fail(f, BVX_ERR_UNSUPPORTED, f->xml.tag, "a version other than 0.1, 1.0 and 2.x");

    /* Files without these attributes are of older versions: counts of 32 bits, little-endian. */
    f->header_size = 4;
    if (bvxi_xml_attribute(&f->xml, "header_type", &v)) {
        f->header_size = bvxi_xml_is(v, "UInt32") ? 4 : bvxi_xml_is(v, "UInt64") ? 8 : 0;
        if (f->header_size == 0) return bvxi_fail_expected(&f->xml.source, v.p, "UInt32 or UInt64");
    }
    if (bvxi_xml_attribute(&f->xml, "byte_order", &v)) {
        f->big = bvxi_xml_is(v, "BigEndian");
        if (!f->big && !bvxi_xml_is(v, "LittleEndian"))
            return bvxi_fail_expected(&f->xml.source, v.p, "LittleEndian or BigEndian");
    }
    /* Whether that matters depends on the array: a text is never compressed. */
    f->compressed = (int8_t)(bvxi_xml_attribute(&f->xml, "compressor", &v) && v.p != v.end);
    if (f->compressed && !bvxi_xml_is(v, "vtkZLibDataCompressor")) f->unpacks = 0;
    return BVX_OK;
}

static bvx_status vti_take_image(vti_file *f)
{
    int64_t unused[6];
    double turn[9];
    bvxi_xml_text v;

    if (f->has_image) return vti_fail(f, BVX_ERR_FORMAT, f->xml.tag, "a second image");
    f->has_image = 1;

    BVXI_TRY(vti_take_extent(f, "WholeExtent", unused));
    for (int a = 0; a < 3; a++) f->spacing[a] = 1.0;
    if (bvxi_xml_attribute(&f->xml, "Origin", &v)) BVXI_TRY(vti_take_doubles(f, v, 3, f->origin));
    if (bvxi_xml_attribute(&f->xml, "Spacing", &v)) BVXI_TRY(vti_take_doubles(f, v, 3, f->spacing));

    /* Only the unit matrix is taken: a grid has no turned axes. */
    if (!bvxi_xml_attribute(&f->xml, "Direction", &v)) return BVX_OK;
    BVXI_TRY(vti_take_doubles(f, v, 9, turn));
    for (int i = 0; i < 9; i++)
        if (turn[i] != (i % 4 == 0 ? 1.0 : 0.0))
            return vti_fail(f, BVX_ERR_UNSUPPORTED, v.p,
                            "Direction turns the axes; a grid's axes are x, y and z (resample the "
                            "image)");
    return BVX_OK;
}

static int32_t vti_kind_of(bvxi_xml_text type)
{
    static const struct {
        const char *name;
        int32_t kind;
    } known[] = {{"UInt8", BVX_SAMPLE_U8},   {"Int8", BVX_SAMPLE_I8},    {"UInt16", BVX_SAMPLE_U16},
                 {"Int16", BVX_SAMPLE_I16},  {"UInt32", BVX_SAMPLE_U32}, {"Int32", BVX_SAMPLE_I32},
                 {"UInt64", BVX_SAMPLE_U64}, {"Int64", BVX_SAMPLE_I64},  {"Float32", BVX_SAMPLE_F32},
                 {"Float64", BVX_SAMPLE_F64}};
    for (size_t i = 0; i < sizeof known / sizeof known[0]; i++)
        if (bvxi_xml_is(type, known[i].name)) return known[i].kind;
    return 0;
}

static bvx_status vti_take_array(vti_file *f, int is_point)
{
    bvxi_xml_text name, type, format, v;
    uint64_t components = 1;
    vti_array a = {0};
    int const is_active = f->has_active && bvxi_xml_attribute(&f->xml, "Name", &name) &&
                          bvxi_xml_same(name, f->active);

    a.rank = is_active  ? (is_point ? VTI_POINTS_ACTIVE : VTI_CELLS_ACTIVE)
             : is_point ? VTI_POINTS_FIRST
                        : VTI_CELLS_FIRST;

    /* A better array may follow: an active one before the first, cells before points. */
    if (a.rank >= f->array.rank) return BVX_OK;
    a.tag = f->xml.tag;
    a.text = f->xml.p;
    if (bvxi_xml_attribute(&f->xml, "NumberOfComponents", &v)) BVXI_TRY(vti_take_count(f, v, &components));
    if (bvxi_xml_attribute(&f->xml, "type", &type)) a.kind = vti_kind_of(type);
    if (a.kind == 0 || components != 1) { /* passed over unless it is the one to be read */
        if (!is_active) return BVX_OK;
        return vti_fail(f, BVX_ERR_UNSUPPORTED, a.tag,
                        "the active scalars are not one number of 8 to 64 bits each");
    }

    /* Only an array that will be read has its format checked; others may have any. */
    if (!bvxi_xml_attribute(&f->xml, "format", &format))
        return vti_fail(f, BVX_ERR_FORMAT, a.tag, "the array has no format");
    a.format = bvxi_xml_is(format, "ascii")      ? VTI_ASCII
               : bvxi_xml_is(format, "binary")   ? VTI_BINARY
               : bvxi_xml_is(format, "appended") ? VTI_APPENDED
                                                 : 0;
    if (a.format == 0) return bvxi_fail_expected(&f->xml.source, format.p, "ascii, binary or appended");
    if (a.format == VTI_APPENDED) {
        if (!bvxi_xml_attribute(&f->xml, "offset", &v))
            return vti_fail(f, BVX_ERR_FORMAT, a.tag, "the array has no offset");
        BVXI_TRY(vti_take_count(f, v, &a.offset));
    }
    f->array = a;
    return BVX_OK;
}

static bvx_status vti_take_element(vti_file *f)
{
    const bvxi_xml *const x = &f->xml;

    if (x->depth == 1) {
        if (bvxi_xml_is_at(x, "VTKFile")) return vti_take_file(f);
        return vti_fail(f, BVX_ERR_FORMAT, x->tag, "the file is not a VTKFile");
    }
    if (bvxi_xml_is_at(x, "VTKFile/ImageData")) return vti_take_image(f);
    if (bvxi_xml_is_at(x, "VTKFile/ImageData/Piece")) {
        if (f->has_piece)
            return vti_fail(f, BVX_ERR_UNSUPPORTED, f->xml.tag,
                            "a second piece; write the image in one (vtkXMLImageDataWriter, "
                            "SetNumberOfPieces(1))");
        f->has_piece = 1;
        return vti_take_extent(f, "Extent", f->extent);
    }
    if (bvxi_xml_is_at(x, "VTKFile/AppendedData")) {
        bvxi_xml_text v;
        /* Raw bytes follow the underscore, so nothing after it can be parsed as XML. */
        f->appended_base64 = (int8_t)(bvxi_xml_attribute(&f->xml, "encoding", &v) &&
                                      bvxi_xml_is(v, "base64"));
        if (!f->appended_base64 && !(bvxi_xml_attribute(&f->xml, "encoding", &v) && bvxi_xml_is(v, "raw")))
            return vti_fail(f, BVX_ERR_FORMAT, f->xml.tag, "AppendedData has no encoding 'raw' or 'base64'");
        f->appended = bvxi_skip_space(f->xml.p, f->xml.source.end);
        if (f->appended == f->xml.source.end || *f->appended != '_')
            return bvxi_fail_expected(&f->xml.source, f->appended, "'_' before the appended data");
        f->appended++;
        return BVX_OK;
    }
    if (bvxi_xml_is_at(x, "VTKFile/ImageData/Piece/CellData") ||
        bvxi_xml_is_at(x, "VTKFile/ImageData/Piece/PointData"))
        f->has_active = (int8_t)bvxi_xml_attribute(x, "Scalars", &f->active);
    if (bvxi_xml_is_at(x, "VTKFile/ImageData/Piece/CellData/DataArray")) return vti_take_array(f, 0);
    if (bvxi_xml_is_at(x, "VTKFile/ImageData/Piece/PointData/DataArray")) return vti_take_array(f, 1);
    return BVX_OK;
}

/* All tags up to the appended data, which are bytes of any kind, or the end. */
static bvx_status vti_read_head(vti_file *f)
{
    int32_t roots = 0;

    f->array.rank = VTI_NO_ARRAY;
    /* Appended data ends the walk over tags: its bytes may hold any character. */
    while (f->appended == NULL) {
        BVXI_TRY(bvxi_xml_next(&f->xml));
        if (f->xml.event == BVXI_XML_END) break;
        if (f->xml.event != BVXI_XML_OPEN) continue;
        roots += f->xml.depth == 1;
        if (roots > 1)
            return vti_fail(f, BVX_ERR_FORMAT, f->xml.tag, "a second element after the file's own");
        BVXI_TRY(vti_take_element(f));
    }

    if (f->array.rank == VTI_NO_ARRAY)
        return BVXI_FILE_FAIL(&f->xml.source, BVX_ERR_FORMAT, "the file has no %s",
                              roots == 0      ? "element VTKFile"
                              : !f->has_image ? "element ImageData"
                              : !f->has_piece ? "element Piece"
                                              : "array of cells or points with one number each");
    if (f->array.format == VTI_APPENDED && f->appended == NULL)
        return vti_fail(f, BVX_ERR_FORMAT, f->array.tag,
                        "the array is appended, but the file has no AppendedData");
    if (f->array.format != VTI_ASCII && f->compressed && !f->unpacks)
        return BVXI_FILE_FAIL_FOR(
            &f->xml.source, BVX_ERR_UNSUPPORTED, BVX_REASON_COMPRESSED,
            "the data is compressed; write it without (vtkXMLImageDataWriter, SetCompressorTypeToNone)");
    return BVX_OK;
}

/* ---- values ---- */

/* Where a text of the file ends: at the next tag. */
static const char *vti_text_end(const vti_file *f, const char *p)
{
    return bvxi_find_byte(p, f->xml.source.end, '<');
}

static bvx_status vti_find_ascii(const vti_file *f, uint64_t voxels, bvxi_dense *d)
{
    d->begin = f->array.text;
    d->end = d->source.end = vti_text_end(f, f->array.text);
    d->encoding = BVXI_DENSE_TEXT;
    d->behind = "the end of the array";
    /* a digit and a space each, none after the last */
    if ((uint64_t)(d->end - d->begin) / 2 + 1 >= voxels) return BVX_OK;
    return BVXI_LINE_FAIL(&f->xml.source, f->array.tag, BVX_ERR_FORMAT, "%u values in %u bytes of text",
                          voxels, (uint64_t)(d->end - d->begin));
}

static bvx_status vti_check_size(const vti_file *f, uint64_t n, uint64_t size)
{
    if (n == size) return BVX_OK;
    return BVXI_LINE_FAIL(&f->xml.source, f->array.tag, BVX_ERR_FORMAT,
                          "the array has %u bytes, its extent asks for %u", n, size);
}

static bvx_status vti_check_length(const vti_file *f, const uint8_t *length, uint64_t size)
{
    uint64_t const n = f->header_size == 4 ? bvxi_load_u32(length, f->big) : bvxi_load_u64(length, f->big);
    return vti_check_size(f, n, size);
}

static BVXI_COLD bvx_status vti_fail_short(const vti_file *f, uint64_t size, const char *at)
{
    return bvxi_fail_short_array(&f->xml.source, f->array.tag, size, at);
}

static bvx_status vti_find_raw(const vti_file *f, const char *p, bvxi_dense *d)
{
    /* The count stands before the data and must be that of the extent, or rows would shift. */
    uint64_t const have = (uint64_t)(f->xml.source.end - p), head = (uint64_t)f->header_size;
    if (have < head) return vti_fail_short(f, d->size, f->xml.source.end);
    BVXI_TRY(vti_check_length(f, (const uint8_t *)p, d->size));
    if (have - head < d->size) return vti_fail_short(f, d->size, f->xml.source.end);
    d->samples.first = (const uint8_t *)p + head;
    return BVX_OK;
}

static bvx_status vti_find_base64(const vti_file *f, const char *p, int is_inline, bvxi_dense *d)
{
    uint8_t length[8];

    /* In base 64 the count and the data are one stream, or two with padding between: both are read alike. */
    bvxi_base64_start(&d->base64, p, vti_text_end(f, p));
    if (!bvxi_base64_take(&d->base64, length, (uint64_t)f->header_size))
        return vti_fail_short(f, d->size, d->base64.p);
    BVXI_TRY(vti_check_length(f, length, d->size));
    /* Three bytes take four characters: what cannot be there is refused before memory is made for it. */
    if (d->size / 3 > (uint64_t)(d->base64.end - d->base64.p) / 4 + 1)
        return vti_fail_short(f, d->size, d->base64.end);
    d->encoding = BVXI_DENSE_BASE64;
    d->behind = is_inline ? "the end of the array" : NULL;
    d->array = f->array.tag;
    return BVX_OK;
}

static bvx_status vti_find_blocks(const vti_file *f, const char *p, int is_text, bvxi_dense *d)
{
    uint64_t size = 0;
    bvxi_base64_start(&d->base64, p, is_text ? vti_text_end(f, p) : f->xml.source.end);
    d->encoding = BVXI_DENSE_BLOCKS;
    d->array = f->array.tag;
    d->is_text = is_text;
    d->number_size = f->header_size;
    BVXI_TRY(bvxi_check_blocks(d, &size));
    return vti_check_size(f, size, d->size);
}

bvx_status bvxi_find_vti(const bvxi_grid_source *source, bvxi_dense *dense)
{
    double corner[3];
    uint64_t dims[3], voxels = 1;
    int fits = 1;

    vti_file f = {.unpacks = source->volume != NULL && source->volume->inflate != NULL};
    bvxi_xml_start(&f.xml, source->ctx, "VTI", source->begin, source->end);
    BVXI_TRY(vti_read_head(&f));
    int const is_point = f.array.rank == VTI_POINTS_ACTIVE || f.array.rank == VTI_POINTS_FIRST;
    /* An extent counts points: cells are one fewer along each axis, which the difference gives. */
    for (int a = 0; a < 3; a++) {
        int64_t const first = f.extent[2 * a], n = f.extent[2 * a + 1] - first + is_point;
        dims[a] = n < 0 ? 0 : (uint64_t)n;
        corner[a] = f.origin[a] + ((double)first - (is_point ? 0.5 : 0.0)) * f.spacing[a];
        voxels = bvxi_mul(voxels, dims[a], &fits);
    }
    BVXI_TRY(bvxi_file_box(source, corner, f.spacing, dims, &dense->box));
    uint64_t const sample = bvxi_sample_size(f.array.kind);
    /* The size is a claim of the file; it is checked before it is compared with bytes. */
    dense->size = bvxi_mul(voxels, sample, &fits);
    if (!fits || dense->size > INT64_MAX)
        return BVXI_FILE_FAIL(source, BVX_ERR_FORMAT, "the piece's extent holds more than any file does");
    dense->placed = 1;
    dense->source = f.xml.source;
    dense->samples.kind = f.array.kind;
    dense->samples.big = f.big;
    bvxi_pack_strides(&dense->samples, &dense->box);
    if (f.array.format == VTI_ASCII) return vti_find_ascii(&f, voxels, dense);
    const char *data = f.array.text;
    int const is_text = f.array.format == VTI_BINARY || f.appended_base64;

    if (f.array.format == VTI_APPENDED) {
        /* The offset is checked before it is added to a pointer. */
        if (f.array.offset > (uint64_t)(f.xml.source.end - f.appended))
            return vti_fail_short(&f, dense->size, f.xml.source.end);
        data = f.appended + f.array.offset;
    }
    if (f.compressed) return vti_find_blocks(&f, data, is_text, dense);
    return is_text ? vti_find_base64(&f, data, f.array.format == VTI_BINARY, dense)
                   : vti_find_raw(&f, data, dense);
}
