/* SPDX-License-Identifier: Apache-2.0
 *
 * libcondyle: knee contact surrogates for programs in C, or in anything that can call C.
 *
 * A model maps the pose of the femoral component relative to the tibial one to the contact wrench
 * on each side of the knee, its derivative by the pose, a bound on its error and a measure of trust.
 * It is read from a surrogate file (.onnx, contract version 1).
 *
 * Units        m, rad, N, Nm everywhere.
 * Frames       F femoral, T tibial; in both x is anterior, y superior, z to the subject's right.
 * Pose         6 numbers: x, y, z of the origin of F in T [m]; theta_x, theta_y, theta_z [rad], the
 *              intrinsic z-y-x angles from F to T: R_TF = Rx(-theta_x) Ry(-theta_y) Rz(-theta_z).
 * Wrench       (2, 6) numbers, row-major: medial, then lateral; Fx, Fy, Fz [N], Mx, My, Mz [Nm] on
 *              the femur, at the origin of F, expressed in T. Compression is Fy > 0. The wrench on
 *              the tibia is the opposite one.
 * Stiffness    (2, 6, 6) numbers, row-major: d wrench_i / d pose_j [N/m, N/rad, Nm/m, Nm/rad], no
 *              change of sign. By the coordinates of the pose, not by rotation vectors.
 * Error        (2, 6) numbers: a bound that holds for 95 % of poses like those it was trained on.
 * Trust        one number: 1 well inside the sampled domains, 0 outside; below 0.5 do not use.
 *              NaN, as is the error, for a file that has the wrench alone.
 *
 * Ownership    The caller owns every array; the library keeps no pointer to one. A model is the
 *              caller's until condyle_destroy().
 * Threads      One model may be evaluated by many threads at once. Only condyle_destroy() needs it
 *              for itself.
 * Errors       Functions return a status, never throw, print or exit. Where it is not CONDYLE_OK,
 *              outputs are not to be used (they may be partly written), and condyle_last_error()
 *              says what is wrong in one line.
 */
#ifndef CONDYLE_H
#define CONDYLE_H

#include <stddef.h>
#include <stdint.h>

#if defined(__GNUC__)
#define CONDYLE_API __attribute__((visibility("default")))
#else
#define CONDYLE_API
#endif

#ifdef __cplusplus
extern "C" {
#endif

#define CONDYLE_POSE_SIZE 6
#define CONDYLE_WRENCH_SIZE 12
#define CONDYLE_STIFFNESS_SIZE 72

typedef enum condyle_status {
  CONDYLE_OK = 0,
  /* The caller's mistake: a null pointer, a size that does not fit, a pose that is not finite, a
     stiffness asked of a file that has none, a file that is missing, damaged or not a surrogate. */
  CONDYLE_INVALID_ARGUMENT = 1,
  /* Something this machine lacks or that failed: no usable onnxruntime, no thread, ... */
  CONDYLE_RUNTIME_ERROR = 2,
  CONDYLE_OUT_OF_MEMORY = 3,
  /* The reference of a hybrid model did not return 0. */
  CONDYLE_REFERENCE_FAILED = 4
} condyle_status;

/* A surrogate, or a hybrid of one and a reference. */
typedef struct condyle_model condyle_model;

/* The reference of a hybrid model, such as the caller's own contact solver. Writes the wrench (12
 * numbers) at a pose (6) and, unless it is null, the stiffness (72); returns 0, or anything else to
 * make the evaluation fail with CONDYLE_REFERENCE_FAILED. Must not throw or longjmp through the
 * library. Called in the thread that evaluates, with a batch one pose after the other; from
 * several threads at once if the caller evaluates from several. */
typedef int (*condyle_reference)(void* user_data, const double* pose, double* wrench,
                                 double* stiffness);

/* Version of the library, "0.1.0". Never null. */
CONDYLE_API const char* condyle_version(void);

/* What went wrong in this thread's last call that did not return CONDYLE_OK; "" before there is
 * one. Never null; valid until this thread's next such call. */
CONDYLE_API const char* condyle_last_error(void);

/* Reads a surrogate file.
 *   path     of the file, in the encoding of the system's file names.
 *   runtime  "auto" or null: Condyle's own kernels where they know the file's graph, else
 *            onnxruntime; "fused" or "onnxruntime": that one or none. onnxruntime is opened by name
 *            when a model needs it: see docs/c_abi.md for where it is looked for.
 *   model    receives the model; null when the status is not CONDYLE_OK. */
CONDYLE_API condyle_status condyle_create(const char* path, const char* runtime,
                                          condyle_model** model);

/* The same, with a reference that is called wherever the surrogate's trust is below 0.75. Below 0.5
 * its loads are the result, with error 0 and trust 1. In between the result goes continuously from
 * the one's loads to the other's: wrench, error and trust are blended, the stiffness is the blend's
 * derivative. `user_data` is handed to it as it is; the caller keeps it alive as long as the model.
 * Refused for a file that has the wrench alone. */
CONDYLE_API condyle_status condyle_create_hybrid(const char* path, const char* runtime,
                                                 condyle_reference reference, void* user_data,
                                                 condyle_model** model);

/* Null is allowed. No call with the model may be under way. */
CONDYLE_API void condyle_destroy(condyle_model* model);

/* One pose.
 *   pose       6 numbers.
 *   wrench     12 numbers, written.
 *   stiffness  72 numbers, error 12 numbers, trust 1 number: written; null if not wanted. */
CONDYLE_API condyle_status condyle_evaluate(const condyle_model* model, const double* pose,
                                            double* wrench, double* stiffness, double* error,
                                            double* trust);

/* Where a batch's results go: arrays and the numbers that they hold. Null and 0 if not wanted; else
 * exactly as many as the poses need. Set what is not used to zero: condyle_batch b = {0}; */
typedef struct condyle_batch {
  double* wrench;
  size_t wrench_size; /* 12 a pose */
  double* stiffness;
  size_t stiffness_size; /* 72 a pose */
  double* error;
  size_t error_size; /* 12 a pose */
  double* trust;
  size_t trust_size; /* 1 a pose */
} condyle_batch;

/* Many poses.
 *   poses       6 numbers a pose, one pose after the other.
 *   poses_size  their number: 6 times that of the poses. 0 is allowed.
 *   threads     to use; 0 for as many as the machine has. Results do not depend on it. */
CONDYLE_API condyle_status condyle_evaluate_batch(const condyle_model* model, const double* poses,
                                                  size_t poses_size, int threads,
                                                  const condyle_batch* results);

/* What the model is, as a JSON text: file, outputs, runtime (and why not the fused one, if so), and
 * the file's metadata: implant, contact law, units, frames, domain bounds, error table, training.
 * Null only for a null model; owned by the model. */
CONDYLE_API const char* condyle_describe(const condyle_model* model);

/* Poses that a hybrid's reference was called for since it was made; 0 without a reference. */
CONDYLE_API condyle_status condyle_reference_calls(const condyle_model* model, uint64_t* calls);

#ifdef __cplusplus
}
#endif

#endif /* CONDYLE_H */
