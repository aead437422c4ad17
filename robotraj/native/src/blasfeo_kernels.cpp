// The inner products of fatrop's linear algebra, for the processor at hand.
//
// The BLASFEO of casadi's wheel is compiled for any x86 processor. Of its matrix products, factorisations, triangular
// solves and products with vectors, most of the time goes to three functions of blocks of four rows. This library
// exports those under their own names; loaded into the process before BLASFEO, they are the ones that BLASFEO calls.
//
// Matrices are in panels of four rows ("lib4"): element (i, j) of a panel stands at i + 4 j.
//   kernel_dgemm_nt_4x4_lib4   D = beta C + alpha A B',   A and B 4 x k, C and D 4 x 4
//   kernel_dgemv_n_4_lib4      z = beta y + alpha A x,    A 4 x k
//   kernel_dgemv_t_4_lib4      z = beta y + alpha A' x,   A k x 4 from row `offset` of a panel on, panels 4 * sda apart
#if defined(__x86_64__)
#include <immintrin.h>
#endif

namespace {

struct Kernels {
  void (*product)(int k, double alpha, const double* A, const double* B, double beta, const double* C, double* D);
  void (*times_vector)(int k, double alpha, const double* A, const double* x, double beta, const double* y, double* z);
  void (*transposed_times_vector)(int k, double alpha, int offset, const double* A, int sda, const double* x,
                                  double beta, const double* y, double* z);
};

/// z = alpha sum + beta y; y is not read where beta is 0.
void finish(double alpha, const double* sum, double beta, const double* y, double* z) {
  for (int i = 0; i < 4; ++i) z[i] = beta == 0.0 ? alpha * sum[i] : alpha * sum[i] + beta * y[i];
}

/// Adds the products of some rows within one panel.
void add_rows(int rows, const double* A, const double* x, double* sum) {
  for (int i = 0; i < rows; ++i)
    for (int j = 0; j < 4; ++j) sum[j] += A[i + 4 * j] * x[i];
}

/// Splits the rows of a transposed product: what is left of the first panel, whole panels, and the rows after them.
template <typename AddPanels>
void in_panels(int k, double alpha, int offset, const double* A, int sda, const double* x, double beta, const double* y,
               double* z, AddPanels&& add_panels) {
  double sum[4] = {};
  if (offset != 0) {
    const int rows = 4 - offset < k ? 4 - offset : k;
    add_rows(rows, A, x, sum);
    A += rows + 4 * (sda - 1);
    x += rows;
    k -= rows;
  }
  const int panels = k / 4;
  add_panels(panels, A, x, sum);
  add_rows(k - 4 * panels, A + 4 * sda * panels, x + 4 * panels, sum);
  finish(alpha, sum, beta, y, z);
}

void product_plain(int k, double alpha, const double* A, const double* B, double beta, const double* C, double* D) {
  double sum[16] = {};
  for (int l = 0; l < k; ++l, A += 4, B += 4)
    for (int j = 0; j < 4; ++j)
      for (int i = 0; i < 4; ++i) sum[4 * j + i] += A[i] * B[j];
  for (int i = 0; i < 16; ++i) D[i] = beta * C[i] + alpha * sum[i];
}

void times_vector_plain(int k, double alpha, const double* A, const double* x, double beta, const double* y,
                        double* z) {
  double sum[4] = {};
  for (int l = 0; l < k; ++l)
    for (int i = 0; i < 4; ++i) sum[i] += A[4 * l + i] * x[l];
  finish(alpha, sum, beta, y, z);
}

void transposed_times_vector_plain(int k, double alpha, int offset, const double* A, int sda, const double* x,
                                   double beta, const double* y, double* z) {
  in_panels(k, alpha, offset, A, sda, x, beta, y, z, [=](int panels, const double* a, const double* v, double* sum) {
    for (int p = 0; p < panels; ++p) add_rows(4, a + 4 * sda * p, v + 4 * p, sum);
  });
}

#if defined(__x86_64__)
#define AVX2 __attribute__((target("avx2,fma")))
#define AVX512 __attribute__((target("avx512f,avx512dq,avx2,fma")))

AVX2 inline void store_product(const __m256d* sum, double alpha, double beta, const double* C, double* D) {
  const __m256d a = _mm256_set1_pd(alpha), b = _mm256_set1_pd(beta);
  for (int j = 0; j < 4; ++j)
    _mm256_storeu_pd(D + 4 * j, _mm256_fmadd_pd(a, sum[j], _mm256_mul_pd(b, _mm256_loadu_pd(C + 4 * j))));
}

// Two columns of A and B at a time, each with sums of its own: the additions do not wait for one another.
AVX2 void product_avx2(int k, double alpha, const double* A, const double* B, double beta, const double* C, double* D) {
  __m256d even[4], odd[4];
  for (int j = 0; j < 4; ++j) even[j] = odd[j] = _mm256_setzero_pd();
  int l = 0;
  for (; l + 1 < k; l += 2, A += 8, B += 8) {
    const __m256d first = _mm256_loadu_pd(A), second = _mm256_loadu_pd(A + 4);
    for (int j = 0; j < 4; ++j) {
      even[j] = _mm256_fmadd_pd(first, _mm256_broadcast_sd(B + j), even[j]);
      odd[j] = _mm256_fmadd_pd(second, _mm256_broadcast_sd(B + 4 + j), odd[j]);
    }
  }
  if (l < k)
    for (int j = 0; j < 4; ++j) even[j] = _mm256_fmadd_pd(_mm256_loadu_pd(A), _mm256_broadcast_sd(B + j), even[j]);
  for (int j = 0; j < 4; ++j) even[j] = _mm256_add_pd(even[j], odd[j]);
  store_product(even, alpha, beta, C, D);
}

/// sum_j += columns 0 and 1 of A times those of B's row j, in the two halves of a register.
AVX512 inline void add_two_columns(const double* A, const double* B, __m512d* sum) {
  const __m512d a = _mm512_loadu_pd(A), b = _mm512_loadu_pd(B);
  sum[0] = _mm512_fmadd_pd(a, _mm512_permutex_pd(b, 0x00), sum[0]);
  sum[1] = _mm512_fmadd_pd(a, _mm512_permutex_pd(b, 0x55), sum[1]);
  sum[2] = _mm512_fmadd_pd(a, _mm512_permutex_pd(b, 0xAA), sum[2]);
  sum[3] = _mm512_fmadd_pd(a, _mm512_permutex_pd(b, 0xFF), sum[3]);
}

AVX512 void product_avx512(int k, double alpha, const double* A, const double* B, double beta, const double* C,
                           double* D) {
  __m512d even[4], odd[4];
  for (int j = 0; j < 4; ++j) even[j] = odd[j] = _mm512_setzero_pd();
  int l = 0;
  for (; l + 3 < k; l += 4, A += 16, B += 16) {
    add_two_columns(A, B, even);
    add_two_columns(A + 8, B + 8, odd);
  }
  if (l + 1 < k) {
    add_two_columns(A, B, even);
    l += 2, A += 8, B += 8;
  }
  __m256d sum[4];
  for (int j = 0; j < 4; ++j) {
    const __m512d both = _mm512_add_pd(even[j], odd[j]);
    sum[j] = _mm256_add_pd(_mm512_castpd512_pd256(both), _mm512_extractf64x4_pd(both, 1));
  }
  if (l < k)
    for (int j = 0; j < 4; ++j) sum[j] = _mm256_fmadd_pd(_mm256_loadu_pd(A), _mm256_broadcast_sd(B + j), sum[j]);
  store_product(sum, alpha, beta, C, D);
}

AVX2 void times_vector_avx2(int k, double alpha, const double* A, const double* x, double beta, const double* y,
                            double* z) {
  __m256d sums[4];
  for (int i = 0; i < 4; ++i) sums[i] = _mm256_setzero_pd();
  int l = 0;
  for (; l + 3 < k; l += 4)
    for (int i = 0; i < 4; ++i)
      sums[i] = _mm256_fmadd_pd(_mm256_loadu_pd(A + 4 * (l + i)), _mm256_broadcast_sd(x + l + i), sums[i]);
  for (; l < k; ++l) sums[0] = _mm256_fmadd_pd(_mm256_loadu_pd(A + 4 * l), _mm256_broadcast_sd(x + l), sums[0]);
  double sum[4];
  _mm256_storeu_pd(sum, _mm256_add_pd(_mm256_add_pd(sums[0], sums[1]), _mm256_add_pd(sums[2], sums[3])));
  finish(alpha, sum, beta, y, z);
}

AVX2 void add_panels_avx2(int panels, const double* A, int sda, const double* x, double* sum) {
  __m256d sums[4];
  for (int j = 0; j < 4; ++j) sums[j] = _mm256_setzero_pd();
  for (int p = 0; p < panels; ++p, A += 4 * sda, x += 4) {
    const __m256d v = _mm256_loadu_pd(x);
    for (int j = 0; j < 4; ++j) sums[j] = _mm256_fmadd_pd(_mm256_loadu_pd(A + 4 * j), v, sums[j]);
  }
  // Each sum's four parts, added across: (0, 1) and (2, 3) in pairs, then the halves.
  const __m256d low = _mm256_hadd_pd(sums[0], sums[1]), high = _mm256_hadd_pd(sums[2], sums[3]);
  const __m256d crossed = _mm256_permute2f128_pd(low, high, 0x21), kept = _mm256_blend_pd(low, high, 0xC);
  _mm256_storeu_pd(sum, _mm256_add_pd(_mm256_loadu_pd(sum), _mm256_add_pd(crossed, kept)));
}

void transposed_times_vector_avx2(int k, double alpha, int offset, const double* A, int sda, const double* x,
                                  double beta, const double* y, double* z) {
  in_panels(k, alpha, offset, A, sda, x, beta, y, z, [=](int panels, const double* a, const double* v, double* sum) {
    add_panels_avx2(panels, a, sda, v, sum);
  });
}
#endif

Kernels chosen() {
#if defined(__x86_64__)
  __builtin_cpu_init();
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) {
    const bool wide = __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq");
    return {wide ? product_avx512 : product_avx2, times_vector_avx2, transposed_times_vector_avx2};
  }
#endif
  return {product_plain, times_vector_plain, transposed_times_vector_plain};
}

const Kernels kernels = chosen();

}  // namespace

#define EXPORTED extern "C" __attribute__((visibility("default")))

EXPORTED void kernel_dgemm_nt_4x4_lib4(int k, double* alpha, double* A, double* B, double* beta, double* C, double* D) {
  kernels.product(k, *alpha, A, B, *beta, C, D);
}

EXPORTED void kernel_dgemv_n_4_lib4(int k, double* alpha, double* A, double* x, double* beta, double* y, double* z) {
  kernels.times_vector(k, *alpha, A, x, *beta, y, z);
}

EXPORTED void kernel_dgemv_t_4_lib4(int k, double* alpha, int offset, double* A, int sda, double* x, double* beta,
                                    double* y, double* z) {
  kernels.transposed_times_vector(k, *alpha, offset, A, sda, x, *beta, y, z);
}
