#include "grid/bspline.h"

void brunt_bspline_weights(int order, double u, double weight[4]) {
    lanes w[4] = {0};
    bspline_weights(order, lanes_set((real)u), w);
    for (int i = 0; i < 4; i++) weight[i] = i <= order ? (double)w[i][0] : 0.0;
}

void brunt_bspline_slopes(int order, double u, double slope[4]) {
    lanes g[4] = {0};
    bspline_slopes(order, lanes_set((real)u), 1, g);
    for (int i = 0; i < 4; i++) slope[i] = i <= order ? (double)g[i][0] : 0.0;
}

void brunt_bspline_levers(int order, double u, const double weight[4], double lever[4]) {
    for (int i = 0; i <= order; i++) lever[i] = order == 1 ? 2 * i - 1 : (order == 2 ? 4 : 3) * weight[i] * (i - u);
}
