/* Doubles decide where the sum is above its error bound (Shewchuk 1997, o3derrboundA), and integers
 * elsewhere: the edges as multiples of their last common bit. */
#include "prep/mesh/mesh_volume.h"

#include <math.h>
#include <stdint.h>

__extension__ typedef __int128 wide;

enum { EDGE_BITS = 40 }; /* three factors and the sum of six products stay below 2^127 */

/* The highest and the lowest bit of any edge, as powers of 2. */
static void find_bits(const double edge[3][3], int *high, int *low) {
    *high = -10000;
    *low = 10000;
    for (int k = 0; k < 9; k++) {
        const double x = fabs(edge[k / 3][k % 3]);
        if (x == 0)
            continue;
        int power;
        const int64_t digits = (int64_t)ldexp(frexp(x, &power), 53);
        const int last = power - 53 + __builtin_ctzll((unsigned long long)digits);
        *high = power > *high ? power : *high;
        *low = last < *low ? last : *low;
    }
}

static int exact_sign(const double edge[3][3]) {
    int high, low;
    find_bits(edge, &high, &low);
    if (high - low > EDGE_BITS)
        return 0;
    wide e[3][3], sum = 0;
    for (int k = 0; k < 9; k++)
        e[k / 3][k % 3] = (int64_t)ldexp(edge[k / 3][k % 3], -low);
    for (int a = 0; a < 3; a++) {
        const int b = (a + 1) % 3, c = (a + 2) % 3;
        sum += e[0][a] * (e[1][b] * e[2][c] - e[1][c] * e[2][b]);
    }
    return sum > 0 ? 1 : sum < 0 ? -1 : 0;
}

int mesh_volume_sign(const float a[3], const float b[3], const float c[3], const float d[3]) {
    double edge[3][3];
    for (int i = 0; i < 3; i++) {
        edge[0][i] = (double)b[i] - (double)a[i];
        edge[1][i] = (double)c[i] - (double)a[i];
        edge[2][i] = (double)d[i] - (double)a[i];
    }
    double volume = 0, most = 0;
    for (int i = 0; i < 3; i++) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        const double plus = edge[1][j] * edge[2][k], minus = edge[1][k] * edge[2][j];
        volume += edge[0][i] * (plus - minus);
        most += fabs(edge[0][i]) * (fabs(plus) + fabs(minus));
    }
    const double error = 0x1p-50 * most;
    if (volume > error || volume < -error)
        return volume > 0 ? 1 : -1;
    return exact_sign((const double(*)[3])edge);
}
