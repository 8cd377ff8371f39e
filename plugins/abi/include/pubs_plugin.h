/*
 * pubs_plugin.h - the C ABI of pubs-engine plugins, ABI number 1.
 *
 * A plugin is a shared library that exports one function, pubs_plugin_v1(), which returns a static
 * pubs_plugin_table. The table names the plugin, tells the JSON Schema of its parameters and points
 * to the functions of its kind: an observation model or a driver. C99, or C++11 and later.
 *
 *     cc -std=c99 -O2 -shared -fPIC -I DIR_OF_THIS_FILE -o libmy_model.so my_model.c -lm
 *     pubs-engine plugins check libmy_model.so
 *     pubs-engine run object.toml --plugin-dir .
 *
 * RULES FOR EVERY FUNCTION
 *
 * Status     Each returns PUBS_OK, PUBS_ABSENT, PUBS_ERROR or PUBS_PANIC.
 * Errors     With PUBS_ERROR or PUBS_PANIC, write a NUL-terminated UTF-8 account into
 *            error[0 .. error_capacity), cut between two characters if it is too long. Say what was
 *            found and what was expected. The buffer is the caller's and may be NULL or empty.
 *            Nothing may leave a function but its return: no C++ exception, no longjmp, no exit.
 * Instances  create/open make one and hand it out through *instance; every other function gets it
 *            back; destroy/close ends it. If create/open fails it leaves *instance alone and frees
 *            whatever it had made. destroy/close of NULL does nothing.
 * Arrays     belong to the caller and are valid during the call only. Element c,i of a [C][N] array
 *            is at c * N + i ("channel-major"). N may be 0. Inputs and outputs never overlap.
 * Units      Joint states are in rad (revolute), m (prismatic) or plain numbers (abstract). Forces
 *            are in N, torques in N m. Actions are indices in the order of the object file. Time is
 *            nanoseconds of the host's monotonic clock (CLOCK_MONOTONIC on Linux).
 * Unloading  A library is never unloaded, so static data and threads of its own are safe.
 *
 * THE SETUP
 *
 * create and open get one UTF-8 JSON object, NOT NUL-terminated:
 *
 *   "joint"        {"type": "revolute"|"prismatic"|"abstract", "lower": s_min, "upper": s_max,
 *                   "integer": bool, "radius_m", "opening_direction": [x, y, z], "hinge_direction",
 *                   "up_direction", "motion_threshold_m"}; what an object does not have is null
 *   "actions"      [{"name", "stop": bool, "mode": "safe"|"high_force",
 *                    "displacement": of one unhindered policy step, "observations": per step}]
 *   "control"      {"rate_hz", "safe_speed_m_s", "high_speed_m_s", "force_threshold_n",
 *                   "force_limit_n", "acceleration_m_s2", "stop_deceleration_m_s2",
 *                   "contact_stiffness_n_per_m"}; null on abstract objects
 *   "belief"       {"particles": N, "spacing": between neighbours}      (observation models only)
 *   "observation"  the [observation] table of the object file           (observation models only)
 *   "driver"       the [driver] table of the object file                (drivers only)
 *   "seed"         unsigned 64-bit number for everything the plugin draws
 *
 * The host has checked the parameters against the plugin's schema before.
 */
#ifndef PUBS_PLUGIN_H
#define PUBS_PLUGIN_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* The number of this ABI, for pubs_plugin_table.abi. */
#define PUBS_PLUGIN_ABI 1u

/* Puts the one exported function into the library's symbol table. */
#if defined(_WIN32)
#define PUBS_PLUGIN_EXPORT __declspec(dllexport)
#elif defined(__GNUC__)
#define PUBS_PLUGIN_EXPORT __attribute__((visibility("default")))
#else
#define PUBS_PLUGIN_EXPORT
#endif

/* What every function returns. */
typedef int32_t pubs_status;
#define PUBS_OK 0     /* done, outputs are filled                                                  */
#define PUBS_ABSENT 1 /* not provided for these arguments, or not known; outputs are untouched     */
#define PUBS_ERROR 2  /* failed, the error buffer says why                                         */
#define PUBS_PANIC 3  /* the plugin's own code broke down (Rust panic, C++ exception caught at the
                         edge); the instance may still be destroyed                                */

/* Text with its length in bytes; UTF-8, alive as long as the process. */
typedef struct pubs_text {
    const char *data;
    size_t length;
} pubs_text;

/* A string literal as pubs_text initialiser:  PUBS_TEXT("my-model") */
#define PUBS_TEXT(literal) { "" literal, sizeof(literal) - 1 }

/* ---------------------------------------------------------------- observation models ---------- */

/* How a channel is distributed, pubs_channel.kind. */
#define PUBS_CHANNEL_GAUSSIAN 0u  /* a real number: normal with mean and sigma at the state AFTER the
                                     move                                                          */
#define PUBS_CHANNEL_BERNOULLI 1u /* 0 or 1: mean is the probability of 1 at the state BEFORE the
                                     move, since the force there decides whether the handle moves;
                                     sigma is not read, but fill it with a finite number           */

/* One component of an observation. */
typedef struct pubs_channel {
    char name[32]; /* UTF-8, closed and filled up with NUL. On a robot "f_d", "f_z", "f_n" (N) or
                      "m_p" (0 or 1); anything on an abstract object                               */
    uint32_t kind; /* PUBS_CHANNEL_GAUSSIAN or PUBS_CHANNEL_BERNOULLI                              */
} pubs_channel;

/*
 * The functions of an observation model Z(o | s, a). After create they may be called from several
 * threads at once on one instance; destroy comes last. The same input must give the same output,
 * bit for bit.
 *
 * A Gaussian model answers moments; the engine then forms the likelihood itself. Another model
 * returns PUBS_ABSENT from moments and provides log_likelihood and sample.
 *
 * N hypotheses about one move are given as the states before[N] and after[N] it. States lie inside
 * the limits. An action that the setup does not have is answered with PUBS_ERROR.
 *
 * An action with "stop" ends the episode: answer with any numbers that keep the rules, or PUBS_ABSENT.
 */
typedef struct pubs_observation_model_table {
    uint32_t size;     /* sizeof(pubs_observation_model_table) */
    uint32_t reserved; /* 0 */

    /* Builds the model of one object. */
    pubs_status (*create)(const uint8_t *setup, size_t setup_length, void **instance, char *error,
                          size_t error_capacity);

    /* Ends the instance. */
    pubs_status (*destroy)(void *instance, char *error, size_t error_capacity);

    /* Writes the first `capacity` channels and, into *count, how many there are. The order is that
       of every [C] axis. At least one, with distinct names. */
    pubs_status (*channels)(void *instance, pubs_channel *channels, size_t capacity, size_t *count,
                            char *error, size_t error_capacity);

    /* Fills mean[C][N] and sigma[C][N]; sigma > 0. PUBS_ABSENT where the model is not Gaussian: then
       always, not for some arguments only. */
    pubs_status (*moments)(void *instance, size_t action, const float *before, const float *after,
                           size_t count, float *mean, float *sigma, char *error,
                           size_t error_capacity);

    /* May be NULL. The same where hypothesis i moved from before + i * spacing to
       after + i * spacing. Points may lie outside the limits: answer there with finite numbers, the
       engine replaces them. Inside it must agree with moments. */
    pubs_status (*moments_grid)(void *instance, size_t action, float before, float after,
                                float spacing, size_t count, float *mean, float *sigma, char *error,
                                size_t error_capacity);

    /* May be NULL where moments answers. ln Z of one observation[C] under each hypothesis, into
       log_likelihood[N]. A density, normalised over the Gaussian channels. */
    pubs_status (*log_likelihood)(void *instance, size_t action, const float *before,
                                  const float *after, size_t count, const float *observation,
                                  float *log_likelihood, char *error, size_t error_capacity);

    /* May be NULL where moments answers. Draws observations[C][N], one per hypothesis, from the
       independent standard normals[C][N]. */
    pubs_status (*sample)(void *instance, size_t action, const float *before, const float *after,
                          size_t count, const float *normals, float *observations, char *error,
                          size_t error_capacity);
} pubs_observation_model_table;

/* ---------------------------------------------------------------- drivers --------------------- */

/* Velocity of the tool: base axes at the tool origin. */
typedef struct pubs_twist {
    double linear_m_s[3];
    double angular_rad_s[3];
} pubs_twist;

/* What the driver says of itself, pubs_reading.status. */
#define PUBS_DRIVER_READY 0u   /* following commands                                                */
#define PUBS_DRIVER_STOPPED 1u /* at rest or ramping to rest: the command expired, or it was told to */
#define PUBS_DRIVER_FAULT 2u   /* not able to move until somebody has looked                        */

/* One measurement. */
typedef struct pubs_reading {
    uint64_t time_ns;           /* when it was taken: monotonic clock, or virtual time after advance_to */
    double position_m[3];       /* tool origin in the base frame                                   */
    double orientation_xyzw[4]; /* tool orientation in the base frame, unit quaternion             */
    double force_n[3];          /* exerted BY the tool ON the object, tool axes, tared             */
    double torque_nm[3];        /* about the tool origin, tool axes, tared                         */
    uint32_t status;            /* PUBS_DRIVER_READY, PUBS_DRIVER_STOPPED or PUBS_DRIVER_FAULT     */
    uint32_t reserved;          /* 0 */
} pubs_reading;

/* Takes a text of `length` bytes of UTF-8, not NUL-terminated, which is valid during the call only. */
typedef void (*pubs_text_sink)(void *context, const uint8_t *text, size_t length);

/*
 * The functions of a driver, called from one thread at a time.
 *
 * The driver must come to rest by itself, by a ramp, when a command's expiry passes without another
 * command. stop and close work in every status.
 */
typedef struct pubs_driver_table {
    uint32_t size;     /* sizeof(pubs_driver_table) */
    uint32_t reserved; /* 0 */

    /* Connects; nothing moves yet. */
    pubs_status (*open)(const uint8_t *setup, size_t setup_length, void **instance, char *error,
                        size_t error_capacity);

    /* Ramps to rest if need be, disconnects, ends the instance. */
    pubs_status (*close)(void *instance, char *error, size_t error_capacity);

    /* Writes the name of the force sensor, NUL-terminated, as [source] sensor of an object file. */
    pubs_status (*sensor)(void *instance, char *text, size_t capacity, char *error,
                          size_t error_capacity);

    /* The newest measurement; returns at once. Where the robot's own safety functions have stopped
     * it (emergency stop, alarm, contact), the error of read or command begins with "safety stop: ":
     * the run then ends as stopped for safety, not as faulty. */
    pubs_status (*read)(void *instance, pubs_reading *reading, char *error, size_t error_capacity);

    /* Moves the tool with `twist` until `expires_ns` on the clock of pubs_reading.time_ns. */
    pubs_status (*command)(void *instance, const pubs_twist *twist, uint64_t expires_ns, char *error,
                           size_t error_capacity);

    /* Takes the present wrench for zero. PUBS_ERROR where the baseline is not quiet. */
    pubs_status (*tare)(void *instance, char *error, size_t error_capacity);

    /* Ramps to rest and stays there until the next command. */
    pubs_status (*stop)(void *instance, char *error, size_t error_capacity);

    /* May be NULL: the driver lives in real time. From the first call on, time stands still but for
       these calls. PUBS_ERROR where time_ns lies in the past. */
    pubs_status (*advance_to)(void *instance, uint64_t time_ns, char *error, size_t error_capacity);

    /* May be NULL. The true joint state (rad or m), for scoring alone; PUBS_ABSENT where nobody knows
       it. */
    pubs_status (*truth)(void *instance, double *state, char *error, size_t error_capacity);

    /* May be NULL; a table whose `size` ends before it is accepted. Looks at everything that open
       needs, without moving and without changing anything, and calls sink(sink_context, text, length)
       once with a JSON array in the order in which to mend things:
           [{"name", "state": "ok"|"warn"|"fault"|"skipped", "found", "cure"}]
       all texts; cure is empty where there is nothing to do. A robot that is not ready is a check
       with the state "fault", not PUBS_ERROR. PUBS_ABSENT where there is nothing to look at. */
    pubs_status (*diagnose)(const uint8_t *setup, size_t setup_length, pubs_text_sink sink,
                            void *sink_context, char *error, size_t error_capacity);
} pubs_driver_table;

/* ---------------------------------------------------------------- the plugin ------------------ */

#define PUBS_KIND_OBSERVATION_MODEL 1u
#define PUBS_KIND_DRIVER 2u

typedef struct pubs_plugin_table {
    uint32_t size;           /* sizeof(pubs_plugin_table)                                          */
    uint32_t abi;            /* PUBS_PLUGIN_ABI                                                    */
    uint32_t kind;           /* PUBS_KIND_OBSERVATION_MODEL or PUBS_KIND_DRIVER                    */
    uint32_t reserved;       /* 0                                                                  */
    pubs_text name;          /* the name that an object file uses                                  */
    pubs_text version;       /* the plugin's own version                                           */
    pubs_text params_schema; /* JSON Schema. Of an observation model: of the [observation] table
                                without the engine's own keys "model", "bias_sd_n" and
                                "correlation_m", so usually one property "params". Of a driver: of
                                [driver] params. Keys that it does not name are refused.            */
    const pubs_observation_model_table *observation_model; /* NULL in a driver                     */
    const pubs_driver_table *driver;                       /* NULL in an observation model         */
} pubs_plugin_table;

/* The one exported function. Define it as
       PUBS_PLUGIN_EXPORT const pubs_plugin_table *pubs_plugin_v1(void) { return &table; }          */
PUBS_PLUGIN_EXPORT const pubs_plugin_table *pubs_plugin_v1(void);

/* ---------------------------------------------------------------- layout, checked ------------- */

#if defined(__cplusplus)
#define PUBS_STATIC_ASSERT(condition, name) static_assert(condition, #name)
#elif defined(__STDC_VERSION__) && __STDC_VERSION__ >= 201112L
#define PUBS_STATIC_ASSERT(condition, name) _Static_assert(condition, #name)
#else
#define PUBS_STATIC_ASSERT(condition, name) typedef char pubs_assert_##name[(condition) ? 1 : -1]
#endif

PUBS_STATIC_ASSERT(sizeof(float) == 4 && sizeof(double) == 8, floats_are_ieee_sized);
PUBS_STATIC_ASSERT(sizeof(pubs_channel) == 36, channel_has_36_bytes);
PUBS_STATIC_ASSERT(sizeof(pubs_twist) == 48, twist_has_48_bytes);
PUBS_STATIC_ASSERT(sizeof(pubs_reading) == 120, reading_has_120_bytes);
PUBS_STATIC_ASSERT(sizeof(pubs_text) == 2 * sizeof(void *), text_has_two_words);
PUBS_STATIC_ASSERT(sizeof(pubs_plugin_table) == 16 + 8 * sizeof(void *), plugin_table_is_packed);
PUBS_STATIC_ASSERT(sizeof(pubs_observation_model_table) == 8 + 7 * sizeof(void *),
                   observation_model_table_is_packed);
PUBS_STATIC_ASSERT(sizeof(pubs_driver_table) == 8 + 10 * sizeof(void *), driver_table_is_packed);

#ifdef __cplusplus
}
#endif

#endif /* PUBS_PLUGIN_H */
