// The list of instances: p2g and g2p for every dimension, kernel, transfer and form, and where each is found.
//
// Names say what an instance is of: dimension or axisymmetric, kernel, transfer, configuration where it is the
// undeformed one (total).
#include "mpm/transfer.h"

#include "mpm/g2p.h"
#include "mpm/p2g.h"

#define P2G(name, dimension, kernel, from, configuration)                                                              \
    static void name(brunt_body *body, int32_t block, real dt) {                                                       \
        p2g(body, block, dt,                                                                                           \
            (transfer_kind){.dim = dimension, .order = kernel, .transfer = from, .form = configuration});              \
    }
#define FIELDS(name, dimension, kernel, with_old, with_affine)                                                         \
    static void name(brunt_body *body, const brunt_block *block, const int32_t *start, brunt_workspace *work) {        \
        fields(body, block, start, work,                                                                               \
               (fields_kind){.dim = dimension, .order = kernel, .old = with_old, .affine = with_affine});              \
    }
#define G2P(name, fields_of, dimension, kernel, to, configuration, part)                                               \
    static void name(brunt_body *body, int32_t block, real dt, real kept, brunt_workspace *work) {                     \
        g2p(body, block, dt, kept, work, fields_of,                                                                    \
            (transfer_kind){.dim = dimension, .order = kernel, .transfer = to, .form = configuration, .stage = part}); \
    }
#define KEEPING(name, fields_of, dimension, kernel, configuration)                                                     \
    static void name(brunt_body *body, int32_t block, real dt, real kept, brunt_workspace *work) {                     \
        g2p(body, block, dt, kept, work, fields_of,                                                                    \
            (transfer_kind){                                                                                           \
                .dim = dimension, .order = kernel, .transfer = BRUNT_APIC, .keeps = true, .form = configuration});     \
    }
#define MUSL(name, fields_of, dimension, to, configuration)                                                            \
    static void name(brunt_body *body, int32_t block, real dt, real kept, brunt_workspace *work) {                     \
        (void)dt;                                                                                                      \
        musl_velocity(body, block, kept, work, fields_of,                                                              \
                      (transfer_kind){.dim = dimension,                                                                \
                                      .order = BRUNT_LINEAR,                                                           \
                                      .transfer = to,                                                                  \
                                      .form = configuration,                                                           \
                                      .stage = MUSL_VELOCITY});                                                        \
    }

// --- particles to grid. Without an affine field PIC and FLIP are the same.
P2G(p2g_2d_linear_pic, 2, BRUNT_LINEAR, BRUNT_PIC, UPDATED)
P2G(p2g_2d_linear_apic, 2, BRUNT_LINEAR, BRUNT_APIC, UPDATED)
P2G(p2g_2d_quadratic_pic, 2, BRUNT_QUADRATIC, BRUNT_PIC, UPDATED)
P2G(p2g_2d_quadratic_apic, 2, BRUNT_QUADRATIC, BRUNT_APIC, UPDATED)
P2G(p2g_2d_cubic_pic, 2, BRUNT_CUBIC, BRUNT_PIC, UPDATED)
P2G(p2g_2d_cubic_apic, 2, BRUNT_CUBIC, BRUNT_APIC, UPDATED)
P2G(p2g_3d_linear_pic, 3, BRUNT_LINEAR, BRUNT_PIC, UPDATED)
P2G(p2g_3d_linear_apic, 3, BRUNT_LINEAR, BRUNT_APIC, UPDATED)
P2G(p2g_3d_quadratic_pic, 3, BRUNT_QUADRATIC, BRUNT_PIC, UPDATED)
P2G(p2g_3d_quadratic_apic, 3, BRUNT_QUADRATIC, BRUNT_APIC, UPDATED)
P2G(p2g_3d_cubic_pic, 3, BRUNT_CUBIC, BRUNT_PIC, UPDATED)
P2G(p2g_3d_cubic_apic, 3, BRUNT_CUBIC, BRUNT_APIC, UPDATED)
P2G(p2g_axisymmetric_linear_pic, 2, BRUNT_LINEAR, BRUNT_PIC, AXISYMMETRIC)
P2G(p2g_axisymmetric_linear_apic, 2, BRUNT_LINEAR, BRUNT_APIC, AXISYMMETRIC)
P2G(p2g_axisymmetric_quadratic_pic, 2, BRUNT_QUADRATIC, BRUNT_PIC, AXISYMMETRIC)
P2G(p2g_axisymmetric_quadratic_apic, 2, BRUNT_QUADRATIC, BRUNT_APIC, AXISYMMETRIC)
P2G(p2g_axisymmetric_cubic_pic, 2, BRUNT_CUBIC, BRUNT_PIC, AXISYMMETRIC)
P2G(p2g_axisymmetric_cubic_apic, 2, BRUNT_CUBIC, BRUNT_APIC, AXISYMMETRIC)
P2G(p2g_2d_quadratic_pic_total, 2, BRUNT_QUADRATIC, BRUNT_PIC, TOTAL)
P2G(p2g_2d_quadratic_apic_total, 2, BRUNT_QUADRATIC, BRUNT_APIC, TOTAL)
P2G(p2g_2d_cubic_pic_total, 2, BRUNT_CUBIC, BRUNT_PIC, TOTAL)
P2G(p2g_2d_cubic_apic_total, 2, BRUNT_CUBIC, BRUNT_APIC, TOTAL)
P2G(p2g_3d_quadratic_pic_total, 3, BRUNT_QUADRATIC, BRUNT_PIC, TOTAL)
P2G(p2g_3d_quadratic_apic_total, 3, BRUNT_QUADRATIC, BRUNT_APIC, TOTAL)
P2G(p2g_3d_cubic_pic_total, 3, BRUNT_CUBIC, BRUNT_PIC, TOTAL)
P2G(p2g_3d_cubic_apic_total, 3, BRUNT_CUBIC, BRUNT_APIC, TOTAL)

// --- the grid's fields at particles: velocity and gradient; with the old velocity; with the affine field; with both
FIELDS(fields_2d_linear, 2, BRUNT_LINEAR, false, false)
FIELDS(fields_2d_linear_old, 2, BRUNT_LINEAR, true, false)
FIELDS(fields_2d_linear_affine, 2, BRUNT_LINEAR, false, true)
FIELDS(fields_2d_quadratic, 2, BRUNT_QUADRATIC, false, false)
FIELDS(fields_2d_quadratic_old, 2, BRUNT_QUADRATIC, true, false)
FIELDS(fields_2d_quadratic_affine, 2, BRUNT_QUADRATIC, false, true)
FIELDS(fields_2d_quadratic_both, 2, BRUNT_QUADRATIC, true, true)
FIELDS(fields_2d_cubic, 2, BRUNT_CUBIC, false, false)
FIELDS(fields_2d_cubic_old, 2, BRUNT_CUBIC, true, false)
FIELDS(fields_2d_cubic_affine, 2, BRUNT_CUBIC, false, true)
FIELDS(fields_2d_cubic_both, 2, BRUNT_CUBIC, true, true)
FIELDS(fields_3d_linear, 3, BRUNT_LINEAR, false, false)
FIELDS(fields_3d_linear_old, 3, BRUNT_LINEAR, true, false)
FIELDS(fields_3d_linear_affine, 3, BRUNT_LINEAR, false, true)
FIELDS(fields_3d_quadratic, 3, BRUNT_QUADRATIC, false, false)
FIELDS(fields_3d_quadratic_old, 3, BRUNT_QUADRATIC, true, false)
FIELDS(fields_3d_quadratic_affine, 3, BRUNT_QUADRATIC, false, true)
FIELDS(fields_3d_quadratic_both, 3, BRUNT_QUADRATIC, true, true)
FIELDS(fields_3d_cubic, 3, BRUNT_CUBIC, false, false)
FIELDS(fields_3d_cubic_old, 3, BRUNT_CUBIC, true, false)
FIELDS(fields_3d_cubic_affine, 3, BRUNT_CUBIC, false, true)
FIELDS(fields_3d_cubic_both, 3, BRUNT_CUBIC, true, true)

// --- grid to particles
G2P(g2p_2d_linear_pic, fields_2d_linear, 2, BRUNT_LINEAR, BRUNT_PIC, UPDATED, AFTER_MUSL)
G2P(g2p_2d_linear_flip, fields_2d_linear, 2, BRUNT_LINEAR, BRUNT_FLIP, UPDATED, AFTER_MUSL)
G2P(g2p_2d_linear_apic, fields_2d_linear_affine, 2, BRUNT_LINEAR, BRUNT_APIC, UPDATED, AFTER_MUSL)
G2P(g2p_2d_quadratic_pic, fields_2d_quadratic, 2, BRUNT_QUADRATIC, BRUNT_PIC, UPDATED, WHOLE)
G2P(g2p_2d_quadratic_flip, fields_2d_quadratic_old, 2, BRUNT_QUADRATIC, BRUNT_FLIP, UPDATED, WHOLE)
G2P(g2p_2d_quadratic_apic, fields_2d_quadratic_affine, 2, BRUNT_QUADRATIC, BRUNT_APIC, UPDATED, WHOLE)
G2P(g2p_2d_cubic_pic, fields_2d_cubic, 2, BRUNT_CUBIC, BRUNT_PIC, UPDATED, WHOLE)
G2P(g2p_2d_cubic_flip, fields_2d_cubic_old, 2, BRUNT_CUBIC, BRUNT_FLIP, UPDATED, WHOLE)
G2P(g2p_2d_cubic_apic, fields_2d_cubic_affine, 2, BRUNT_CUBIC, BRUNT_APIC, UPDATED, WHOLE)
G2P(g2p_3d_linear_pic, fields_3d_linear, 3, BRUNT_LINEAR, BRUNT_PIC, UPDATED, AFTER_MUSL)
G2P(g2p_3d_linear_flip, fields_3d_linear, 3, BRUNT_LINEAR, BRUNT_FLIP, UPDATED, AFTER_MUSL)
G2P(g2p_3d_linear_apic, fields_3d_linear_affine, 3, BRUNT_LINEAR, BRUNT_APIC, UPDATED, AFTER_MUSL)
G2P(g2p_3d_quadratic_pic, fields_3d_quadratic, 3, BRUNT_QUADRATIC, BRUNT_PIC, UPDATED, WHOLE)
G2P(g2p_3d_quadratic_flip, fields_3d_quadratic_old, 3, BRUNT_QUADRATIC, BRUNT_FLIP, UPDATED, WHOLE)
G2P(g2p_3d_quadratic_apic, fields_3d_quadratic_affine, 3, BRUNT_QUADRATIC, BRUNT_APIC, UPDATED, WHOLE)
G2P(g2p_3d_cubic_pic, fields_3d_cubic, 3, BRUNT_CUBIC, BRUNT_PIC, UPDATED, WHOLE)
G2P(g2p_3d_cubic_flip, fields_3d_cubic_old, 3, BRUNT_CUBIC, BRUNT_FLIP, UPDATED, WHOLE)
G2P(g2p_3d_cubic_apic, fields_3d_cubic_affine, 3, BRUNT_CUBIC, BRUNT_APIC, UPDATED, WHOLE)
G2P(g2p_axisymmetric_linear_pic, fields_2d_linear, 2, BRUNT_LINEAR, BRUNT_PIC, AXISYMMETRIC, AFTER_MUSL)
G2P(g2p_axisymmetric_linear_flip, fields_2d_linear, 2, BRUNT_LINEAR, BRUNT_FLIP, AXISYMMETRIC, AFTER_MUSL)
G2P(g2p_axisymmetric_linear_apic, fields_2d_linear_affine, 2, BRUNT_LINEAR, BRUNT_APIC, AXISYMMETRIC, AFTER_MUSL)
G2P(g2p_axisymmetric_quadratic_pic, fields_2d_quadratic, 2, BRUNT_QUADRATIC, BRUNT_PIC, AXISYMMETRIC, WHOLE)
G2P(g2p_axisymmetric_quadratic_flip, fields_2d_quadratic_old, 2, BRUNT_QUADRATIC, BRUNT_FLIP, AXISYMMETRIC, WHOLE)
G2P(g2p_axisymmetric_quadratic_apic, fields_2d_quadratic_affine, 2, BRUNT_QUADRATIC, BRUNT_APIC, AXISYMMETRIC, WHOLE)
G2P(g2p_axisymmetric_cubic_pic, fields_2d_cubic, 2, BRUNT_CUBIC, BRUNT_PIC, AXISYMMETRIC, WHOLE)
G2P(g2p_axisymmetric_cubic_flip, fields_2d_cubic_old, 2, BRUNT_CUBIC, BRUNT_FLIP, AXISYMMETRIC, WHOLE)
G2P(g2p_axisymmetric_cubic_apic, fields_2d_cubic_affine, 2, BRUNT_CUBIC, BRUNT_APIC, AXISYMMETRIC, WHOLE)
G2P(g2p_2d_quadratic_pic_total, fields_2d_quadratic, 2, BRUNT_QUADRATIC, BRUNT_PIC, TOTAL, WHOLE)
G2P(g2p_2d_quadratic_flip_total, fields_2d_quadratic_old, 2, BRUNT_QUADRATIC, BRUNT_FLIP, TOTAL, WHOLE)
G2P(g2p_2d_quadratic_apic_total, fields_2d_quadratic_affine, 2, BRUNT_QUADRATIC, BRUNT_APIC, TOTAL, WHOLE)
G2P(g2p_2d_cubic_pic_total, fields_2d_cubic, 2, BRUNT_CUBIC, BRUNT_PIC, TOTAL, WHOLE)
G2P(g2p_2d_cubic_flip_total, fields_2d_cubic_old, 2, BRUNT_CUBIC, BRUNT_FLIP, TOTAL, WHOLE)
G2P(g2p_2d_cubic_apic_total, fields_2d_cubic_affine, 2, BRUNT_CUBIC, BRUNT_APIC, TOTAL, WHOLE)
G2P(g2p_3d_quadratic_pic_total, fields_3d_quadratic, 3, BRUNT_QUADRATIC, BRUNT_PIC, TOTAL, WHOLE)
G2P(g2p_3d_quadratic_flip_total, fields_3d_quadratic_old, 3, BRUNT_QUADRATIC, BRUNT_FLIP, TOTAL, WHOLE)
G2P(g2p_3d_quadratic_apic_total, fields_3d_quadratic_affine, 3, BRUNT_QUADRATIC, BRUNT_APIC, TOTAL, WHOLE)
G2P(g2p_3d_cubic_pic_total, fields_3d_cubic, 3, BRUNT_CUBIC, BRUNT_PIC, TOTAL, WHOLE)
G2P(g2p_3d_cubic_flip_total, fields_3d_cubic_old, 3, BRUNT_CUBIC, BRUNT_FLIP, TOTAL, WHOLE)
G2P(g2p_3d_cubic_apic_total, fields_3d_cubic_affine, 3, BRUNT_CUBIC, BRUNT_APIC, TOTAL, WHOLE)

// --- of APIC that keeps a share: no linear kernel, on which APIC makes energy
KEEPING(g2p_2d_quadratic_keeping, fields_2d_quadratic_both, 2, BRUNT_QUADRATIC, UPDATED)
KEEPING(g2p_2d_cubic_keeping, fields_2d_cubic_both, 2, BRUNT_CUBIC, UPDATED)
KEEPING(g2p_3d_quadratic_keeping, fields_3d_quadratic_both, 3, BRUNT_QUADRATIC, UPDATED)
KEEPING(g2p_3d_cubic_keeping, fields_3d_cubic_both, 3, BRUNT_CUBIC, UPDATED)
KEEPING(g2p_axisymmetric_quadratic_keeping, fields_2d_quadratic_both, 2, BRUNT_QUADRATIC, AXISYMMETRIC)
KEEPING(g2p_axisymmetric_cubic_keeping, fields_2d_cubic_both, 2, BRUNT_CUBIC, AXISYMMETRIC)
KEEPING(g2p_2d_quadratic_keeping_total, fields_2d_quadratic_both, 2, BRUNT_QUADRATIC, TOTAL)
KEEPING(g2p_2d_cubic_keeping_total, fields_2d_cubic_both, 2, BRUNT_CUBIC, TOTAL)
KEEPING(g2p_3d_quadratic_keeping_total, fields_3d_quadratic_both, 3, BRUNT_QUADRATIC, TOTAL)
KEEPING(g2p_3d_cubic_keeping_total, fields_3d_cubic_both, 3, BRUNT_CUBIC, TOTAL)

// --- the linear kernel's first stage
MUSL(musl_2d_linear_pic, fields_2d_linear, 2, BRUNT_PIC, UPDATED)
MUSL(musl_2d_linear_flip, fields_2d_linear_old, 2, BRUNT_FLIP, UPDATED)
MUSL(musl_2d_linear_apic, fields_2d_linear, 2, BRUNT_APIC, UPDATED)
MUSL(musl_3d_linear_pic, fields_3d_linear, 3, BRUNT_PIC, UPDATED)
MUSL(musl_3d_linear_flip, fields_3d_linear_old, 3, BRUNT_FLIP, UPDATED)
MUSL(musl_3d_linear_apic, fields_3d_linear, 3, BRUNT_APIC, UPDATED)
MUSL(musl_axisymmetric_linear_pic, fields_2d_linear, 2, BRUNT_PIC, AXISYMMETRIC)
MUSL(musl_axisymmetric_linear_flip, fields_2d_linear_old, 2, BRUNT_FLIP, AXISYMMETRIC)
MUSL(musl_axisymmetric_linear_apic, fields_2d_linear, 2, BRUNT_APIC, AXISYMMETRIC)

// --- where each is found: rows of plane strain, space, rings; columns by kernel

#define P2G_ROW(form)                                                                                                  \
    {                                                                                                                  \
        {p2g_##form##_linear_pic, p2g_##form##_linear_apic},                                                           \
            {p2g_##form##_quadratic_pic, p2g_##form##_quadratic_apic}, {                                               \
            p2g_##form##_cubic_pic, p2g_##form##_cubic_apic                                                            \
        }                                                                                                              \
    }
#define G2P_ROW(form)                                                                                                  \
    {                                                                                                                  \
        {g2p_##form##_linear_pic, g2p_##form##_linear_flip, g2p_##form##_linear_apic},                                 \
            {g2p_##form##_quadratic_pic, g2p_##form##_quadratic_flip, g2p_##form##_quadratic_apic}, {                  \
            g2p_##form##_cubic_pic, g2p_##form##_cubic_flip, g2p_##form##_cubic_apic                                   \
        }                                                                                                              \
    }
#define MUSL_ROW(form)                                                                                                 \
    { musl_##form##_linear_pic, musl_##form##_linear_flip, musl_##form##_linear_apic }
#define P2G_TOTAL(dim)                                                                                                 \
    {                                                                                                                  \
        {NULL}, {p2g_##dim##_quadratic_pic_total, p2g_##dim##_quadratic_apic_total}, {                                 \
            p2g_##dim##_cubic_pic_total, p2g_##dim##_cubic_apic_total                                                  \
        }                                                                                                              \
    }
#define G2P_TOTAL(dim)                                                                                                 \
    {                                                                                                                  \
        {NULL}, {g2p_##dim##_quadratic_pic_total, g2p_##dim##_quadratic_flip_total, g2p_##dim##_quadratic_apic_total}, \
        {                                                                                                              \
            g2p_##dim##_cubic_pic_total, g2p_##dim##_cubic_flip_total, g2p_##dim##_cubic_apic_total                    \
        }                                                                                                              \
    }

static int table_row(int dim, bool axisymmetric) { return axisymmetric ? 2 : dim - 2; }

brunt_p2g_fn *brunt_find_p2g(int dim, bool axisymmetric, brunt_kernel kernel, brunt_transfer transfer) {
    static brunt_p2g_fn *const table[3][3][2] = {P2G_ROW(2d), P2G_ROW(3d), P2G_ROW(axisymmetric)};
    return table[table_row(dim, axisymmetric)][kernel - 1][transfer == BRUNT_APIC];
}

brunt_g2p_fn *brunt_find_g2p(int dim, bool axisymmetric, brunt_kernel kernel, brunt_transfer transfer) {
    static brunt_g2p_fn *const table[3][3][3] = {G2P_ROW(2d), G2P_ROW(3d), G2P_ROW(axisymmetric)};
    return table[table_row(dim, axisymmetric)][kernel - 1][transfer];
}

brunt_g2p_fn *brunt_find_musl_velocity(int dim, bool axisymmetric, brunt_kernel kernel, brunt_transfer transfer) {
    static brunt_g2p_fn *const table[3][3] = {MUSL_ROW(2d), MUSL_ROW(3d), MUSL_ROW(axisymmetric)};
    return kernel == BRUNT_LINEAR ? table[table_row(dim, axisymmetric)][transfer] : NULL;
}

brunt_p2g_fn *brunt_find_total_p2g(int dim, brunt_kernel kernel, brunt_transfer transfer) {
    static brunt_p2g_fn *const table[2][3][2] = {P2G_TOTAL(2d), P2G_TOTAL(3d)};
    return table[dim - 2][kernel - 1][transfer == BRUNT_APIC];
}

brunt_g2p_fn *brunt_find_total_g2p(int dim, brunt_kernel kernel, brunt_transfer transfer) {
    static brunt_g2p_fn *const table[2][3][3] = {G2P_TOTAL(2d), G2P_TOTAL(3d)};
    return table[dim - 2][kernel - 1][transfer];
}

brunt_g2p_fn *brunt_find_keeping_g2p(int dim, bool axisymmetric, brunt_kernel kernel, bool total) {
    static brunt_g2p_fn *const table[3][3] = {
        {NULL, g2p_2d_quadratic_keeping, g2p_2d_cubic_keeping},
        {NULL, g2p_3d_quadratic_keeping, g2p_3d_cubic_keeping},
        {NULL, g2p_axisymmetric_quadratic_keeping, g2p_axisymmetric_cubic_keeping}};
    static brunt_g2p_fn *const undeformed[2][3] = {{NULL, g2p_2d_quadratic_keeping_total, g2p_2d_cubic_keeping_total},
                                                   {NULL, g2p_3d_quadratic_keeping_total, g2p_3d_cubic_keeping_total}};
    return total ? undeformed[dim - 2][kernel - 1] : table[table_row(dim, axisymmetric)][kernel - 1];
}
