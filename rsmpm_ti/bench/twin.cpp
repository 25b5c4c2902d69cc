// The yardstick's scheme by hand: one thread, particles in cell order, a cell's node sums in locals, no atomics.
// Reads numbers of steps from standard input, one per line, and answers each with M particle-steps/s.
// g++ -O3 -march=native -ffast-math -DWIDTH=2 (linear) or 3 (quadratic B-splines)
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <utility>
#include <vector>

constexpr int W = WIDTH, S = W * W;
constexpr double SHIFT = W == 2 ? 0.0 : 0.5;

static inline void weights(double r, double inv, double* w, double* d) {
  if (W == 2) {
    w[0] = 1 - r, w[1] = r;
    d[0] = -inv, d[1] = inv;
  } else {
    w[0] = 0.5 * (1.5 - r) * (1.5 - r), w[1] = 0.75 - (r - 1) * (r - 1), w[W - 1] = 0.5 * (r - 0.5) * (r - 0.5);
    d[0] = (r - 1.5) * inv, d[1] = -2 * (r - 1) * inv, d[W - 1] = (r - 0.5) * inv;
  }
}

int main() {
  const int nx = 100, ny = 200, pad = 4;
  const double dx = 0.5e-3, h = dx / 2, inv = 1 / dx, E = 17e9, nu = 0.14, rho = 2600, tensile = 2e6;
  const double lam = E * nu / ((1 + nu) * (1 - 2 * nu)), mu = E / 2 / (1 + nu), phi = 40 * M_PI / 180;
  const double c_cos = 5.95e6 * std::cos(phi), s_phi = std::sin(phi);
  const double dt = 0.5 * dx / std::sqrt((lam + 2 * mu) / rho), mp = rho * h * h;
  const int gx = nx + 2 * pad, gy = ny + 2 * pad, G = gx * gy, N = 4 * nx * ny;
  std::vector<double> px(N), py(N), vx(N, 0.01), vy(N), sxx(N), syy(N), sxy(N), szz(N), vol(N, h * h);
  std::vector<int> failed(N), start(G + 1);
  std::vector<double> gm(G), gvx(G), gvy(G), gfx(G), gfy(G);

  std::vector<std::vector<std::pair<double, double>>> cells(G);
  for (int j = 0; j < 2 * ny; j++)
    for (int i = 0; i < 2 * nx; i++) {
      const double x = (i + 0.5) * h + pad * dx, y = (j + 0.5) * h + pad * dx;
      cells[int(y * inv - SHIFT) * gx + int(x * inv - SHIFT)].push_back({x, y});
    }
  int count = 0;
  for (int k = 0; k < G; k++) {
    start[k] = count;
    for (const auto& x : cells[k]) px[count] = x.first, py[count++] = x.second;
  }
  start[G] = count;

  auto step = [&] {
    for (auto* g : {&gm, &gvx, &gvy, &gfx, &gfy}) std::fill(g->begin(), g->end(), 0.0);
    for (int j = 0; j < gy - W + 1; j++)
      for (int i = 0; i < gx - W + 1; i++) {
        const int k = j * gx + i;
        if (start[k] == start[k + 1]) continue;
        double m[S] = {0}, ax[S] = {0}, ay[S] = {0}, fx[S] = {0}, fy[S] = {0};
        for (int p = start[k]; p < start[k + 1]; p++) {
          double wx[W], wy[W], ex[W], ey[W];
          weights(px[p] * inv - i, inv, wx, ex);
          weights(py[p] * inv - j, inv, wy, ey);
          const double a = sxx[p] * vol[p], b = syy[p] * vol[p], d = sxy[p] * vol[p], mx = mp * vx[p], my = mp * vy[p];
          for (int q = 0; q < S; q++) {
            const double n = wx[q % W] * wy[q / W], X = ex[q % W] * wy[q / W], Y = wx[q % W] * ey[q / W];
            m[q] += n * mp, ax[q] += n * mx, ay[q] += n * my, fx[q] -= a * X + d * Y, fy[q] -= d * X + b * Y;
          }
        }
        for (int q = 0; q < S; q++) {
          const int n = k + q % W + q / W * gx;
          gm[n] += m[q], gvx[n] += ax[q], gvy[n] += ay[q], gfx[n] += fx[q], gfy[n] += fy[q];
        }
      }
    for (int k = 0; k < G; k++)
      if (gm[k] > 1e-12) {
        const double im = 1 / gm[k], a = dt * gfx[k] * im, b = dt * gfy[k] * im;
        gvx[k] = gvx[k] * im + a, gvy[k] = gvy[k] * im + b, gfx[k] = a, gfy[k] = b;
      }
    for (int j = 0; j < gy - W + 1; j++)
      for (int i = 0; i < gx - W + 1; i++) {
        const int k = j * gx + i;
        if (start[k] == start[k + 1]) continue;
        double v0[S], v1[S], d0[S], d1[S];
        for (int q = 0; q < S; q++) {
          const int n = k + q % W + q / W * gx;
          v0[q] = gvx[n], v1[q] = gvy[n], d0[q] = gfx[n], d1[q] = gfy[n];
        }
        for (int p = start[k]; p < start[k + 1]; p++) {
          double wx[W], wy[W], ex[W], ey[W], va = 0, vb = 0, da = 0, db = 0, lxx = 0, lyy = 0, lxy = 0, lyx = 0;
          weights(px[p] * inv - i, inv, wx, ex);
          weights(py[p] * inv - j, inv, wy, ey);
          for (int q = 0; q < S; q++) {
            const double n = wx[q % W] * wy[q / W], X = ex[q % W] * wy[q / W], Y = wx[q % W] * ey[q / W];
            va += n * v0[q], vb += n * v1[q], da += n * d0[q], db += n * d1[q];
            lxx += X * v0[q], lyy += Y * v1[q], lxy += Y * v0[q], lyx += X * v1[q];
          }
          px[p] += dt * va, py[p] += dt * vb, vx[p] += da, vy[p] += db;
          const double xx = lxx * dt, yy = lyy * dt, xy = 0.5 * dt * (lxy + lyx), spin = 0.5 * dt * (lyx - lxy);
          const double tr = xx + yy, a = sxx[p], b = syy[p], d = sxy[p];
          vol[p] *= 1 + tr;
          double s0 = a - 2 * spin * d + lam * tr + 2 * mu * xx, s1 = b + 2 * spin * d + lam * tr + 2 * mu * yy;
          double s2 = szz[p] + lam * tr, s3 = d + spin * (a - b) + 2 * mu * xy;
          const double mean = 0.5 * (s0 + s1), radius = std::sqrt(0.25 * (s0 - s1) * (s0 - s1) + s3 * s3);
          const double most = std::max(mean + radius, s2), least = std::min(mean - radius, s2);
          if (most >= tensile || 0.5 * (most - least) >= c_cos - 0.5 * (most + least) * s_phi) {
            failed[p] = 1;
            s0 = s1 = s2 = std::min((s0 + s1 + s2) / 3, 0.0), s3 = 0;
          }
          sxx[p] = s0, syy[p] = s1, szz[p] = s2, sxy[p] = s3;
        }
      }
  };

  for (int steps; std::scanf("%d", &steps) == 1;) {
    const auto begin = std::chrono::steady_clock::now();
    for (int k = 0; k < steps; k++) step();
    const double s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    std::printf("%.6f %g\n", 1e-6 * N * steps / s, vx[5]);  // vx, or nothing would need to be computed
    std::fflush(stdout);
  }
}
