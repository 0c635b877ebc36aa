/* SPDX-License-Identifier: Apache-2.0
 *
 * Evaluates a surrogate file at one pose and at a batch around it, and once more with a reference
 * of the caller's own for the poses that the surrogate does not know.
 *
 *   cc evaluate.c $(pkg-config --cflags --libs condyle) -o evaluate
 *   ./evaluate surrogate.onnx
 */
#include <condyle.h>
#include <stdio.h>
#include <stdlib.h>

static const char* const kLoads[6] = {"Fx [N]", "Fy [N]", "Fz [N]", "Mx [Nm]", "My [Nm]", "Mz [Nm]"};

/* Stands for the caller's own contact solver: here a linear spring against Fo's height, shared by
 * the sides. user_data is whatever was given to condyle_create_hybrid(). */
static int spring(void* user_data, const double* pose, double* wrench, double* stiffness) {
  const double* modulus = user_data; /* [N/m] */
  const double depth = 0.04 - pose[1];
  int i;
  for (i = 0; i < CONDYLE_WRENCH_SIZE; ++i) wrench[i] = 0.0;
  if (stiffness != NULL) {
    for (i = 0; i < CONDYLE_STIFFNESS_SIZE; ++i) stiffness[i] = 0.0;
  }
  if (depth <= 0.0) return 0;
  for (i = 0; i < 2; ++i) {
    wrench[6 * i + 1] = 0.5 * *modulus * depth;
    if (stiffness != NULL) stiffness[36 * i + 6 * 1 + 1] = -0.5 * *modulus;
  }
  return 0;
}

static int failed(condyle_status status) {
  if (status == CONDYLE_OK) return 0;
  fprintf(stderr, "condyle: status %d: %s\n", (int)status, condyle_last_error());
  return 1;
}

static int one_pose(const condyle_model* model, const double* pose) {
  double wrench[CONDYLE_WRENCH_SIZE], stiffness[CONDYLE_STIFFNESS_SIZE];
  double error[CONDYLE_WRENCH_SIZE], trust;
  int i;
  if (failed(condyle_evaluate(model, pose, wrench, stiffness, error, &trust))) return 1;
  printf("%-8s %22s %22s\n", "", "medial", "lateral");
  for (i = 0; i < 6; ++i) {
    printf("%-8s %12.3f +- %6.3f %12.3f +- %6.3f\n", kLoads[i], wrench[i], error[i], wrench[6 + i],
           error[6 + i]);
  }
  printf("trust %.3f, dFy/dy of the medial side %.4g N/m\n", trust, stiffness[6 * 1 + 1]);
  return 0;
}

/* The same pose, lowered step by step. */
static int batch(const condyle_model* model, const double* pose) {
  enum { kPoses = 5 };
  double poses[6 * kPoses], wrench[12 * kPoses], trust[kPoses];
  condyle_batch results = {0};
  int i, j;
  for (i = 0; i < kPoses; ++i) {
    for (j = 0; j < 6; ++j) poses[6 * i + j] = pose[j] - (j == 1 ? 1e-4 * i : 0.0);
  }
  results.wrench = wrench;
  results.wrench_size = 12 * kPoses;
  results.trust = trust;
  results.trust_size = kPoses;
  if (failed(condyle_evaluate_batch(model, poses, 6 * kPoses, 1, &results))) return 1;
  for (i = 0; i < kPoses; ++i) {
    printf("lowered by %.1f mm: Fy %.1f N, trust %.3f\n", 0.1 * i,
           wrench[12 * i + 1] + wrench[12 * i + 7], trust[i]);
  }
  return 0;
}

static int hybrid(const char* file, const double* pose) {
  double modulus = 2e6, far_away[6], wrench[CONDYLE_WRENCH_SIZE], trust;
  condyle_model* model;
  uint64_t calls = 0;
  int i, bad;
  if (failed(condyle_create_hybrid(file, NULL, spring, &modulus, &model))) return 1;
  for (i = 0; i < 6; ++i) far_away[i] = pose[i];
  far_away[1] = 0.03; /* far below anything that was sampled */
  bad = failed(condyle_evaluate(model, far_away, wrench, NULL, NULL, &trust)) ||
        failed(condyle_reference_calls(model, &calls));
  if (!bad) {
    printf("hybrid: Fy %.1f N by the reference, called %u time(s)\n", wrench[1] + wrench[7],
           (unsigned)calls);
  }
  condyle_destroy(model);
  return bad;
}

int main(int argc, char** argv) {
  double pose[6] = {0.006, 0.0415, 0.0, 0.0, 0.0, -0.3};
  condyle_model* model;
  int i, bad;
  if (argc != 2 && argc != 8) {
    fprintf(stderr, "usage: %s surrogate.onnx [x y z theta_x theta_y theta_z]\n", argv[0]);
    return 2;
  }
  for (i = 2; i < argc; ++i) pose[i - 2] = strtod(argv[i], NULL);
  printf("libcondyle %s\n", condyle_version());
  if (failed(condyle_create(argv[1], NULL, &model))) return 1;
  if (argc == 2) printf("%s\n", condyle_describe(model));
  bad = one_pose(model, pose) || batch(model, pose) || hybrid(argv[1], pose);
  condyle_destroy(model);
  return bad;
}
