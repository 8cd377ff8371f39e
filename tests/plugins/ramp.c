/*
 * An observation model in C, as a user may write one: the door gets heavier as it opens.
 *
 * f_d is normal with mean = slope_n_per_rad * state and sigma 0.5 N; the handle moves (m_p) with
 * probability 0.95. -DFAULT_ABI, -DFAULT_NAN and -DFAULT_CREATE make broken ones; -DLIKELIHOODS
 * gives likelihoods and samples in place of moments.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "pubs_plugin.h"

#define ACTIONS 5

typedef struct ramp {
    float slope;
} ramp;

static pubs_status fail(char *error, size_t capacity, const char *text) {
    if (error != NULL && capacity > 0) {
        snprintf(error, capacity, "%s", text);
    }
    return PUBS_ERROR;
}

/* The number after `key` in the setup, which has no closing NUL. */
static int number_after(const uint8_t *setup, size_t length, const char *key, float *number) {
    char *text = malloc(length + 1);
    char *found;
    if (text == NULL) {
        return 0;
    }
    memcpy(text, setup, length);
    text[length] = '\0';
    found = strstr(text, key);
    if (found != NULL) {
        *number = strtof(found + strlen(key), NULL);
    }
    free(text);
    return found != NULL;
}

static pubs_status create(const uint8_t *setup, size_t length, void **instance, char *error, size_t capacity) {
    float slope = 0.0f;
    ramp *own;
#ifdef FAULT_CREATE
    return fail(error, capacity, "the licence of this ramp has run out");
#endif
    if (!number_after(setup, length, "\"slope_n_per_rad\":", &slope)) {
        return fail(error, capacity, "the setup has no `slope_n_per_rad`");
    }
    own = malloc(sizeof *own);
    if (own == NULL) {
        return fail(error, capacity, "out of memory");
    }
    own->slope = slope;
    *instance = own;
    return PUBS_OK;
}

static pubs_status destroy(void *instance, char *error, size_t capacity) {
    (void)error;
    (void)capacity;
    free(instance);
    return PUBS_OK;
}

static pubs_status channels(void *instance, pubs_channel *channels, size_t capacity, size_t *count, char *error,
                            size_t error_capacity) {
    static const pubs_channel own[2] = {{"f_d", PUBS_CHANNEL_GAUSSIAN}, {"m_p", PUBS_CHANNEL_BERNOULLI}};
    (void)instance;
    (void)error;
    (void)error_capacity;
    memcpy(channels, own, (capacity < 2 ? capacity : 2) * sizeof *own);
    *count = 2;
    return PUBS_OK;
}

static pubs_status moments(void *instance, size_t action, const float *before, const float *after, size_t count,
                           float *mean, float *sigma, char *error, size_t error_capacity) {
    const ramp *own = instance;
    size_t i;
    (void)before;
    if (action >= ACTIONS) {
        return fail(error, error_capacity, "there is no such action");
    }
#ifdef LIKELIHOODS
    return PUBS_ABSENT;
#endif
    for (i = 0; i < count; i++) {
        mean[i] = own->slope * after[i];
        sigma[i] = 0.5f;
        mean[count + i] = 0.95f;
        sigma[count + i] = 1.0f;
    }
#ifdef FAULT_NAN
    if (count > 0) {
        mean[count / 2] = NAN;
    }
#endif
    return PUBS_OK;
}

#ifdef LIKELIHOODS
static pubs_status log_likelihood(void *instance, size_t action, const float *before, const float *after,
                                  size_t count, const float *observation, float *log_likelihood, char *error,
                                  size_t error_capacity) {
    const ramp *own = instance;
    size_t i;
    (void)before;
    if (action >= ACTIONS) {
        return fail(error, error_capacity, "there is no such action");
    }
    for (i = 0; i < count; i++) {
        float deviation = (observation[0] - own->slope * after[i]) / 0.5f;
        /* 0.2257914 = ln(0.5 sqrt(2 pi)) */
        log_likelihood[i] = -0.5f * deviation * deviation - 0.2257914f + logf(observation[1] > 0.5f ? 0.95f : 0.05f);
    }
    return PUBS_OK;
}

static pubs_status sample(void *instance, size_t action, const float *before, const float *after, size_t count,
                          const float *normals, float *observations, char *error, size_t error_capacity) {
    const ramp *own = instance;
    size_t i;
    (void)before;
    if (action >= ACTIONS) {
        return fail(error, error_capacity, "there is no such action");
    }
    for (i = 0; i < count; i++) {
        observations[i] = own->slope * after[i] + 0.5f * normals[i];
        /* -1.6448536 is the 5th percentile of a standard normal. */
        observations[count + i] = normals[count + i] > -1.6448536f ? 1.0f : 0.0f;
    }
    return PUBS_OK;
}

static const pubs_observation_model_table functions = {
    sizeof(pubs_observation_model_table), 0, create, destroy, channels, moments, NULL, log_likelihood, sample,
};
#else
static const pubs_observation_model_table functions = {
    sizeof(pubs_observation_model_table), 0, create, destroy, channels, moments, NULL, NULL, NULL,
};
#endif

static const pubs_plugin_table table = {
    sizeof(pubs_plugin_table),
#ifdef FAULT_ABI
    PUBS_PLUGIN_ABI + 6,
#else
    PUBS_PLUGIN_ABI,
#endif
    PUBS_KIND_OBSERVATION_MODEL,
    0,
    PUBS_TEXT("ramp"),
    PUBS_TEXT("1.0.0"),
    PUBS_TEXT("{ \"properties\": { \"params\": { \"type\": \"object\","
              "  \"properties\": { \"slope_n_per_rad\": { \"type\": \"number\", \"minimum\": 0 } },"
              "  \"required\": [\"slope_n_per_rad\"] } }, \"required\": [\"params\"] }"),
    &functions,
    NULL,
};

const pubs_plugin_table *pubs_plugin_v1(void) { return &table; }
