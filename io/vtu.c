#include "vtu.h"

#include <stdlib.h>
#include <string.h>
#include <zlib.h>

#include "atomic_file.h"
#include "error.h"
#include "memory.h"

// Uncompressed bytes of a zlib block. VTK's own default is 32768; larger blocks compress better and read as fast.
enum { BLOCK_BYTES = 262144 };

typedef struct byte_buffer {
    unsigned char *data;
    size_t size, capacity;
} byte_buffer;

static int reserve(byte_buffer *buffer, size_t more, brunt_error *error) {
    void *memory = buffer->data;
    int status = brunt_reserve(&memory, &buffer->capacity, buffer->size + more, buffer->size);
    buffer->data = memory;
    return status ? brunt_fail(error, BRUNT_FAILED, "out of memory while writing a picture") : BRUNT_OK;
}

static void put_word(unsigned char *at, uint64_t word) {
    for (int i = 0; i < 8; i++) at[i] = (unsigned char)(word >> (8 * i));
}

// Appends one array as VTK's compressed blocks: [blocks, block size, size of the last one if partial else 0, compressed
// sizes...] and the blocks. An array of no bytes is [0, block size, 0]; one that fills its last block has partial size
// 0.
static int append_compressed(byte_buffer *out, const unsigned char *data, size_t bytes, brunt_error *error) {
    size_t full = bytes / BLOCK_BYTES, partial = bytes % BLOCK_BYTES, blocks = full + (partial ? 1 : 0);
    size_t header = 8 * (3 + blocks), start = out->size;
    int status = reserve(out, header + blocks * compressBound(BLOCK_BYTES), error);
    if (status) return status;
    put_word(out->data + start, blocks);
    put_word(out->data + start + 8, BLOCK_BYTES);
    put_word(out->data + start + 16, partial);
    out->size += header;
    for (size_t b = 0; b < blocks; b++) {
        size_t size = b < full ? BLOCK_BYTES : partial;
        uLongf packed = compressBound(BLOCK_BYTES);
        // Level 1: pictures are written while a run waits; higher levels take several times as long for a few percent.
        if (compress2(out->data + out->size, &packed, data + b * BLOCK_BYTES, size, 1) != Z_OK)
            return brunt_fail(error, BRUNT_FAILED, "zlib could not compress a picture");
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

// Starts the element of an array in the header and its data in the appended part.
static int append_array(FILE *header, byte_buffer *appended, byte_buffer *scratch, const brunt_vtu_array *array,
                        int64_t count, bool float32, brunt_error *error) {
    static const char *const components3[] = {"X", "Y", "Z"};
    static const char *const components6[] = {"XX", "YY", "ZZ", "XY", "YZ", "XZ"};
    static const char *const components9[] = {"XX", "XY", "XZ", "YX", "YY", "YZ", "ZX", "ZY", "ZZ"};
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
    fprintf(header, " format=\"appended\" offset=\"%zu\"/>\n", appended->size);

    scratch->size = 0;
    int status = reserve(scratch, values * width, error);
    if (status) return status;
    for (size_t i = 0; i < values; i++)
        if (array->integers)
            put_word(scratch->data + 8 * i, (uint64_t)array->integers[i]);
        else
            put_double(scratch->data + width * i, array->values[i], float32);
    return append_compressed(appended, scratch->data, values * width, error);
}

static int append_cells(FILE *header, byte_buffer *appended, byte_buffer *scratch, int64_t count, brunt_error *error) {
    fputs("      <Cells>\n", header);
    const char *const names[] = {"connectivity", "offsets"};
    for (int a = 0; a < 2; a++) {
        fprintf(header, "        <DataArray type=\"Int64\" Name=\"%s\" format=\"appended\" offset=\"%zu\"/>\n",
                names[a], appended->size);
        scratch->size = 0;
        int status = reserve(scratch, 8 * (size_t)count, error);
        if (status) return status;
        for (int64_t i = 0; i < count; i++) put_word(scratch->data + 8 * i, (uint64_t)(i + a));
        status = append_compressed(appended, scratch->data, 8 * (size_t)count, error);
        if (status) return status;
    }
    enum { VTK_VERTEX = 1 };
    fprintf(header, "        <DataArray type=\"UInt8\" Name=\"types\" format=\"appended\" offset=\"%zu\"/>\n",
            appended->size);
    memset(scratch->data, VTK_VERTEX, (size_t)count);
    int status = append_compressed(appended, scratch->data, (size_t)count, error);
    fputs("      </Cells>\n", header);
    return status;
}

static const char *first_of(const brunt_vtu_array *arrays, int count, int components) {
    for (int a = 0; a < count; a++)
        if (arrays[a].components == components && !arrays[a].integers) return arrays[a].name;
    return NULL;
}

static int write_header(FILE *header, byte_buffer *appended, byte_buffer *scratch, double time, int64_t count,
                        const double *points, const brunt_vtu_array *arrays, int array_count, bool float32,
                        brunt_error *error) {
    fputs("<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\" "
          "header_type=\"UInt64\" compressor=\"vtkZLibDataCompressor\">\n  <UnstructuredGrid>\n",
          header);
    fprintf(header,
            "    <FieldData>\n      <DataArray type=\"Float64\" Name=\"TimeValue\" NumberOfTuples=\"1\" "
            "format=\"ascii\">%.17g</DataArray>\n    </FieldData>\n",
            time);
    fprintf(header, "    <Piece NumberOfPoints=\"%lld\" NumberOfCells=\"%lld\">\n      <PointData", (long long)count,
            (long long)count);
    const char *scalar = first_of(arrays, array_count, 1), *vector = first_of(arrays, array_count, 3);
    if (scalar) {
        fputs(" Scalars=\"", header);
        put_name(header, scalar);
        fputc('"', header);
    }
    if (vector) {
        fputs(" Vectors=\"", header);
        put_name(header, vector);
        fputc('"', header);
    }
    fputs(">\n", header);
    int status = BRUNT_OK;
    for (int a = 0; a < array_count && !status; a++)
        status = append_array(header, appended, scratch, &arrays[a], count, float32, error);
    if (status) return status;
    fputs("      </PointData>\n      <Points>\n", header);
    const brunt_vtu_array place = {.name = "Points", .components = 3, .values = points};
    status = append_array(header, appended, scratch, &place, count, float32, error);
    if (status) return status;
    fputs("      </Points>\n", header);
    status = append_cells(header, appended, scratch, count, error);
    fputs("    </Piece>\n  </UnstructuredGrid>\n  <AppendedData encoding=\"raw\">\n   _", header);
    return status;
}

int brunt_vtu_write(const char *path, double time, int64_t count, const double *points, const brunt_vtu_array *arrays,
                    int array_count, bool float32, brunt_error *error) {
    brunt_atomic_file file;
    int status = brunt_atomic_open(&file, path, error);
    if (status) return status;
    byte_buffer appended = {0}, scratch = {0};
    // Space for one byte at least, so that an empty array has an address.
    status = reserve(&scratch, 1, error);
    if (!status)
        status =
            write_header(file.stream, &appended, &scratch, time, count, points, arrays, array_count, float32, error);
    if (!status) status = brunt_atomic_write(&file, appended.data, appended.size, error);
    if (!status) {
        fputs("\n  </AppendedData>\n</VTKFile>\n", file.stream);
        status = brunt_atomic_commit(&file, error);
    } else {
        brunt_atomic_abandon(&file);
    }
    brunt_free(appended.data);
    brunt_free(scratch.data);
    return status;
}

int brunt_vtu_write_body(const char *path, brunt_world *world, int32_t body, const char (*fields)[64], int field_count,
                         bool float32, brunt_error *error) {
    int64_t count = brunt_body_particles(world, body);
    int32_t position = brunt_body_find_field(world, body, "position");
    if (position < 0)
        return brunt_fail(error, BRUNT_FAILED, "body '%s' has no field 'position'", brunt_body_name(world, body));
    brunt_vtu_array *arrays = brunt_alloc(sizeof *arrays * (size_t)(field_count + 1));
    double **memory = brunt_alloc(sizeof *memory * (size_t)(field_count + 1));
    int64_t *ids = brunt_alloc(sizeof *ids * (size_t)count);
    double *points = brunt_alloc(sizeof *points * 3 * (size_t)count);
    int status = arrays && memory && ids && points
                     ? BRUNT_OK
                     : brunt_fail(error, BRUNT_FAILED, "out of memory while writing %s", path);
    int array_count = 0;
    if (!status) {
        brunt_body_read(world, body, position, points);
        for (int64_t i = 0; i < count; i++) ids[i] = i;
        arrays[array_count++] = (brunt_vtu_array){.name = "id", .components = 1, .integers = ids};
    }
    for (int f = 0; f < field_count && !status; f++) {
        int32_t field = brunt_body_find_field(world, body, fields[f]);
        // The id is always there, and the position is the points.
        if (field < 0 || strcmp(fields[f], "id") == 0 || strcmp(fields[f], "position") == 0) continue;
        brunt_field_info info = brunt_body_field(world, body, field);
        double *values = brunt_alloc(sizeof *values * (size_t)count * (size_t)info.components);
        if (!values) {
            status = brunt_fail(error, BRUNT_FAILED, "out of memory while writing %s", path);
            break;
        }
        brunt_body_read(world, body, field, values);
        memory[array_count] = values;
        arrays[array_count++] = (brunt_vtu_array){.name = info.name, .components = info.components, .values = values};
    }
    if (!status)
        status = brunt_vtu_write(path, brunt_world_time(world), count, points, arrays, array_count, float32, error);
    for (int a = 0; a < array_count; a++) brunt_free(memory[a]);
    brunt_free(arrays);
    brunt_free(memory);
    brunt_free(ids);
    brunt_free(points);
    return status;
}

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

int brunt_vtu_describe(const char *path, FILE *out, brunt_error *error) {
    FILE *file = fopen(path, "rbe");
    if (!file) return brunt_fail(error, BRUNT_IO_ERROR, "%s: cannot open the file", path);
    // All that describes the file comes before the appended data; a collection of a million entries still fits.
    enum { LIMIT = 64 << 20 };
    size_t capacity = 0, size = 0;
    void *memory = NULL;
    int status = BRUNT_OK;
    for (;;) {
        if (brunt_reserve(&memory, &capacity, size + 65537, size)) {
            status = brunt_fail(error, BRUNT_FAILED, "out of memory while reading %s", path);
            break;
        }
        size_t got = fread((char *)memory + size, 1, 65536, file);
        size += got;
        ((char *)memory)[size] = 0;
        if (got == 0 || size > LIMIT || strstr((char *)memory, "<AppendedData")) break;
    }
    fclose(file);
    const char *text = memory;
    if (!status && !strstr(text, "<VTKFile"))
        status = brunt_fail(error, BRUNT_BAD_INPUT, "%s: not a VTK XML file", path);
    char a[256], b[256], c[256];
    for (const char *at = status ? NULL : strchr(text, '<'); at; at = strchr(at + 1, '<')) {
        const char *end = strchr(at, '>');
        if (!end) break;
        if (!strncmp(at, "<VTKFile", 8) && attribute(at, end, "type", a, sizeof a))
            fprintf(out, "VTK XML file, %s\n", a);
        if (!strncmp(at, "<Piece", 6) && attribute(at, end, "NumberOfPoints", a, sizeof a))
            fprintf(out, "particles  %s\n", a);
        if (!strncmp(at, "<DataArray", 10) && attribute(at, end, "Name", a, sizeof a)) {
            if (!strcmp(a, "TimeValue")) {
                fprintf(out, "time       %.17g s\n", strtod(end + 1, NULL));
            } else if (attribute(at, end, "type", b, sizeof b)) {
                if (!attribute(at, end, "NumberOfComponents", c, sizeof c)) strcpy(c, "1");
                fprintf(out, "array      %-28s %s x %s\n", a, b, c);
            }
        }
        if (!strncmp(at, "<DataSet", 8) && attribute(at, end, "timestep", a, sizeof a) &&
            attribute(at, end, "name", b, sizeof b) && attribute(at, end, "file", c, sizeof c))
            fprintf(out, "picture    t = %s s  %s  %s\n", a, b, c);
        if (!strncmp(at, "<AppendedData", 13)) break;
    }
    brunt_free(memory);
    return status;
}
