#include "io/output/vtu.h"

#include <libdeflate.h>
#include <stdlib.h>
#include <string.h>

#include "io/file/atomic_file.h"
#include "base/error.h"
#include "io/file/input_file.h"
#include "base/array.h"
#include "base/memory.h"

// VTK's own key for the unit of an array.
#define UNIT_BEGIN "<InformationKey name=\"UNITS_LABEL\" location=\"vtkDataArray\">"
#define UNIT_END "</InformationKey>"

// Uncompressed bytes of a zlib block. VTK's own default is 32768; larger blocks compress better and read as fast.
enum { BLOCK_BYTES = 262144 };

typedef struct byte_buffer {
    unsigned char *data;
    size_t size, capacity;
} byte_buffer;

// A file while it is put together: its XML, and the data that follow it.
typedef struct vtu_writer {
    FILE *header;
    byte_buffer appended, scratch;
    struct libdeflate_compressor *compressor;
    bool float32;
    brunt_error *error;
} vtu_writer;

static int reserve(byte_buffer *buffer, size_t more, brunt_error *error) {
    return BRUNT_RESERVE_IN(buffer->data, buffer->capacity, buffer->size + more, buffer->size)
               ? brunt_fail(error, BRUNT_FAILED, "out of memory while writing a picture")
               : BRUNT_OK;
}

static void put_word(unsigned char *at, uint64_t word) {
    for (int i = 0; i < 8; i++) at[i] = (unsigned char)(word >> (8 * i));
}

// Appends one array as VTK's compressed blocks: [blocks, block size, size of the last one if partial else 0, compressed
// sizes...] and the blocks. An array of no bytes is [0, block size, 0]; one that fills its last block has partial size
// 0.
static int append_compressed(vtu_writer *w, const unsigned char *data, size_t bytes) {
    byte_buffer *out = &w->appended;
    size_t full = bytes / BLOCK_BYTES, partial = bytes % BLOCK_BYTES, blocks = full + (partial ? 1 : 0);
    size_t header = 8 * (3 + blocks), start = out->size;
    const size_t room = libdeflate_zlib_compress_bound(w->compressor, BLOCK_BYTES);
    int status = reserve(out, header + blocks * room, w->error);
    if (status) return status;
    put_word(out->data + start, blocks);
    put_word(out->data + start + 8, BLOCK_BYTES);
    put_word(out->data + start + 16, partial);
    out->size += header;
    for (size_t b = 0; b < blocks; b++) {
        const size_t size = b < full ? BLOCK_BYTES : partial;
        const size_t packed =
            libdeflate_zlib_compress(w->compressor, data + b * BLOCK_BYTES, size, out->data + out->size, room);
        if (!packed) return brunt_fail(w->error, BRUNT_FAILED, "a picture could not be compressed");
        put_word(out->data + start + 24 + 8 * b, packed);
        out->size += packed;
    }
    return BRUNT_OK;
}

static void put_double(unsigned char *at, double value, bool float32) {
    if (float32) {
        float narrow = (float)value;
        uint32_t word;
        memcpy(&word, &narrow, 4);
        for (int i = 0; i < 4; i++) at[i] = (unsigned char)(word >> (8 * i));
    } else {
        uint64_t word;
        memcpy(&word, &value, 8);
        put_word(at, word);
    }
}

// VTK and ParaView's calculator want plain names.
static void put_name(FILE *out, const char *name) {
    for (const char *c = name; *c; c++) {
        bool plain = (*c >= 'a' && *c <= 'z') || (*c >= 'A' && *c <= 'Z') || (*c >= '0' && *c <= '9');
        fputc(plain ? *c : '_', out);
    }
}

// Ends the element of an array, with its unit if it has one.
static void put_unit(FILE *out, const char *unit) {
    if (unit && strcmp(unit, "1"))
        fprintf(out, ">" UNIT_BEGIN "%s" UNIT_END "</DataArray>\n", unit);
    else
        fputs("/>\n", out);
}

// Starts the element of an array in the header and its data in the appended part.
static int append_array(vtu_writer *w, const brunt_vtu_array *array, int64_t count) {
    FILE *header = w->header;
    byte_buffer *scratch = &w->scratch;
    const bool float32 = w->float32;
    static const char *const components3[3] = {"X", "Y", "Z"};
    static const char *const components6[6] = {"XX", "YY", "ZZ", "XY", "YZ", "XZ"};
    static const char *const components9[9] = {"XX", "XY", "XZ", "YX", "YY", "YZ", "ZX", "ZY", "ZZ"};
    const char *const *names = array->components == 3   ? components3
                               : array->components == 6 ? components6
                               : array->components == 9 ? components9
                                                        : NULL;
    const char *type = array->integers ? "Int64" : float32 ? "Float32" : "Float64";
    size_t width = array->integers || !float32 ? 8 : 4, values = (size_t)count * (size_t)array->components;

    fprintf(header, "        <DataArray type=\"%s\" Name=\"", type);
    put_name(header, array->name);
    fprintf(header, "\" NumberOfComponents=\"%d\"", array->components);
    for (int c = 0; names && c < array->components; c++) fprintf(header, " ComponentName%d=\"%s\"", c, names[c]);
    fprintf(header, " format=\"appended\" offset=\"%zu\"", w->appended.size);
    put_unit(header, array->unit);

    scratch->size = 0;
    int status = reserve(scratch, values * width, w->error);
    if (status) return status;
    for (size_t i = 0; i < values; i++)
        if (array->integers)
            put_word(scratch->data + 8 * i, (uint64_t)array->integers[i]);
        else
            put_double(scratch->data + width * i, array->values[i], float32);
    return append_compressed(w, scratch->data, values * width);
}

// Starts an integer array of the cells. Its data are in `scratch`.
static int append_integers(vtu_writer *w, const char *type, const char *name) {
    fprintf(w->header, "        <DataArray type=\"%s\" Name=\"%s\" format=\"appended\" offset=\"%zu\"/>\n", type, name,
            w->appended.size);
    return append_compressed(w, w->scratch.data, w->scratch.size);
}

static int append_cells(vtu_writer *w, const brunt_vtu_grid *grid) {
    FILE *header = w->header;
    byte_buffer *scratch = &w->scratch;
    enum { VTK_VERTEX = 1 };
    int64_t count = grid->cells ? grid->cell_count : grid->point_count, nodes = grid->cells ? grid->cell_nodes : 1;
    fputs("      <Cells>\n", header);
    scratch->size = 0;
    int status = reserve(scratch, 8 * (size_t)(count * nodes), w->error);
    if (status) return status;
    for (int64_t i = 0; i < count * nodes; i++)
        put_word(scratch->data + 8 * i, (uint64_t)(grid->cells ? grid->cells[i] : i));
    scratch->size = 8 * (size_t)(count * nodes);
    status = append_integers(w, "Int64", "connectivity");
    for (int64_t i = 0; i < count; i++) put_word(scratch->data + 8 * i, (uint64_t)((i + 1) * nodes));
    scratch->size = 8 * (size_t)count;
    if (!status) status = append_integers(w, "Int64", "offsets");
    memset(scratch->data, grid->cells ? grid->cell_type : VTK_VERTEX, (size_t)count);
    scratch->size = (size_t)count;
    if (!status) status = append_integers(w, "UInt8", "types");
    fputs("      </Cells>\n", header);
    return status;
}

static void put_active(FILE *header, const char *kind, int components, const brunt_vtu_array *arrays, int count,
                       bool at_cells) {
    for (int a = 0; a < count; a++) {
        if (arrays[a].components != components || arrays[a].integers || arrays[a].at_cells != at_cells) continue;
        fprintf(header, " %s=\"", kind);
        put_name(header, arrays[a].name);
        fputc('"', header);
        return;
    }
}

// The arrays at the points, or at the cells.
static int append_data(vtu_writer *w, const brunt_vtu_grid *grid, const brunt_vtu_array *arrays, int array_count,
                       bool at_cells) {
    FILE *header = w->header;
    const char *element = at_cells ? "CellData" : "PointData";
    int status = BRUNT_OK;
    fprintf(header, "      <%s", element);
    put_active(header, "Scalars", 1, arrays, array_count, at_cells);
    put_active(header, "Vectors", 3, arrays, array_count, at_cells);
    fputs(">\n", header);
    for (int a = 0; a < array_count && !status; a++)
        if (arrays[a].at_cells == at_cells)
            status = append_array(w, &arrays[a], at_cells ? grid->cell_count : grid->point_count);
    fprintf(header, "      </%s>\n", element);
    return status;
}

static int write_header(vtu_writer *w, double time, const brunt_vtu_grid *grid, const brunt_vtu_array *arrays,
                        int array_count) {
    FILE *header = w->header;
    fputs("<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\" "
          "header_type=\"UInt64\" compressor=\"vtkZLibDataCompressor\">\n  <UnstructuredGrid>\n",
          header);
    fprintf(header,
            "    <FieldData>\n      <DataArray type=\"Float64\" Name=\"TimeValue\" NumberOfTuples=\"1\" "
            "format=\"ascii\">%.17g</DataArray>\n    </FieldData>\n",
            time);
    fprintf(header, "    <Piece NumberOfPoints=\"%lld\" NumberOfCells=\"%lld\">\n", (long long)grid->point_count,
            (long long)(grid->cells ? grid->cell_count : grid->point_count));
    int status = append_data(w, grid, arrays, array_count, false);
    // Only elements have data of cells: that tells their files from those of particles.
    if (!status && grid->cells) status = append_data(w, grid, arrays, array_count, true);
    if (status) return status;
    fputs("      <Points>\n", header);
    const brunt_vtu_array place = {.name = "Points", .components = 3, .values = grid->points};
    status = append_array(w, &place, grid->point_count);
    if (status) return status;
    fputs("      </Points>\n", header);
    status = append_cells(w, grid);
    fputs("    </Piece>\n  </UnstructuredGrid>\n  <AppendedData encoding=\"raw\">\n   _", header);
    return status;
}

int brunt_vtu_write(const char *path, double time, const brunt_vtu_grid *grid, const brunt_vtu_array *arrays,
                    int array_count, bool float32, brunt_error *error) {
    brunt_atomic_file file;
    int status = brunt_atomic_open(&file, path, error);
    if (status) return status;
    vtu_writer w = {.header = file.stream, .float32 = float32, .error = error};
    // Level 1: pictures are written while a run waits; higher levels take several times as long for a few percent.
    w.compressor = libdeflate_alloc_compressor(1);
    if (!w.compressor) status = brunt_fail(error, BRUNT_FAILED, "out of memory while writing a picture");
    // Space for one byte at least, so that an empty array has an address.
    if (!status) status = reserve(&w.scratch, 1, error);
    if (!status) status = write_header(&w, time, grid, arrays, array_count);
    if (!status) status = brunt_atomic_write(&file, w.appended.data, w.appended.size, error);
    if (!status) {
        fputs("\n  </AppendedData>\n</VTKFile>\n", file.stream);
        status = brunt_atomic_commit(&file, error);
    } else {
        brunt_atomic_abandon(&file);
    }
    libdeflate_free_compressor(w.compressor);
    brunt_free(w.appended.data);
    brunt_free(w.scratch.data);
    return status;
}

// ---------------------------------------------------------------------------------------------------- describing

// Finds attribute="value" in one XML element; false when it is not there.
static bool attribute(const char *element, const char *end, const char *name, char *out, size_t room) {
    size_t length = strlen(name);
    for (const char *c = element; c + length + 2 < end; c++) {
        if (c[0] != ' ' || strncmp(c + 1, name, length) || c[1 + length] != '=' || c[2 + length] != '"') continue;
        const char *value = c + 3 + length;
        size_t n = 0;
        while (value + n < end && value[n] != '"' && n + 1 < room) {
            out[n] = value[n];
            n++;
        }
        out[n] = 0;
        return true;
    }
    return false;
}

// The unit of the array whose element begins before `end`; false: it has none.
static bool unit_behind(const char *end, char *out, size_t room) {
    const size_t length = strlen(UNIT_BEGIN);
    const char *unit = end + 1 + length, *last = strncmp(end + 1, UNIT_BEGIN, length) ? NULL : strchr(unit, '<');
    if (!last || (size_t)(last - unit) >= room) return false;
    snprintf(out, room, "%.*s", (int)(last - unit), unit);
    return true;
}

int brunt_vtu_describe(const char *path, FILE *out, brunt_error *error) {
    const char *why;
    FILE *file = brunt_input_open(path, &why);
    if (!file) return brunt_fail(error, BRUNT_IO_ERROR, "%s: cannot open the file: %s", path, why);
    // All that describes the file comes before the appended data; a collection of a million entries still fits.
    enum { LIMIT = 64 << 20 };
    size_t capacity = 0, size = 0;
    char *text = NULL;
    int status = BRUNT_OK;
    for (;;) {
        if (BRUNT_RESERVE_IN(text, capacity, size + 65537, size)) {
            status = brunt_fail(error, BRUNT_FAILED, "out of memory while reading %s", path);
            break;
        }
        size_t got = fread(text + size, 1, 65536, file);
        size += got;
        text[size] = 0;
        if (got == 0 || size > LIMIT || strstr(text, "<AppendedData")) break;
    }
    fclose(file);
    bool elements = !status && strstr(text, "<CellData");
    if (!status && !strstr(text, "<VTKFile"))
        status = brunt_fail(error, BRUNT_BAD_INPUT, "%s: not a VTK XML file", path);
    char a[256], b[256], c[256];
    for (const char *at = status ? NULL : strchr(text, '<'); at; at = strchr(at + 1, '<')) {
        const char *end = strchr(at, '>');
        if (!end) break;
        if (!strncmp(at, "<VTKFile", 8) && attribute(at, end, "type", a, sizeof a))
            fprintf(out, "VTK XML file, %s\n", a);
        if (!strncmp(at, "<Piece", 6) && attribute(at, end, "NumberOfPoints", a, sizeof a))
            fprintf(out, elements ? "nodes      %s\n" : "particles  %s\n", a);
        if (!strncmp(at, "<Piece", 6) && elements && attribute(at, end, "NumberOfCells", a, sizeof a))
            fprintf(out, "elements   %s\n", a);
        if (!strncmp(at, "<PointData", 10) && elements) fputs("at the nodes\n", out);
        if (!strncmp(at, "<CellData", 9)) fputs("at the elements\n", out);
        if (!strncmp(at, "<DataArray", 10) && attribute(at, end, "Name", a, sizeof a)) {
            if (!strcmp(a, "TimeValue")) {
                fprintf(out, "time       %.17g s\n", strtod(end + 1, NULL));
            } else if (attribute(at, end, "type", b, sizeof b)) {
                if (!attribute(at, end, "NumberOfComponents", c, sizeof c)) strcpy(c, "1");
                fprintf(out, "array      %-28s %s x %s", a, b, c);
                if (unit_behind(end, a, sizeof a)) fprintf(out, " [%s]", a);
                fputc('\n', out);
            }
        }
        if (!strncmp(at, "<DataSet", 8) && attribute(at, end, "timestep", a, sizeof a) &&
            attribute(at, end, "name", b, sizeof b) && attribute(at, end, "file", c, sizeof c))
            fprintf(out, "picture    t = %s s  %s  %s\n", a, b, c);
        if (!strncmp(at, "<AppendedData", 13)) break;
    }
    brunt_free(text);
    return status;
}
