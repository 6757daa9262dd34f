// The list of closed forms and its scene. A form with several values is a series whose parameter is the substep or
// the edge of a mesh.
#include "closed_forms.h"

#include <math.h>
#include <stdlib.h>

enum
{
    PARAMETERS_MAX = 6,
    SETTINGS_MAX = 128,
};

#define MIN_ERROR 1e-9

typedef enum closed_parameter
{
    SUBSTEPS,   // the parameter is the length of a substep
    ITERATIONS, // of 10 substeps
    CELLS,      // of a clamped strip
    LEVEL,      // of an icosphere
} closed_parameter;

typedef struct closed_form
{
    const char* name; // with the unit of what is measured
    closed_fn* run;
    double first, second;
    closed_parameter parameter;
    int values[PARAMETERS_MAX];
    int value_count;
    double order;
} closed_form;

// Positions and velocities of a substep are updated one after the other: first order. At rest only the remainder h^2
// k / m of an iteration is an error: second order. So are volume and area of a mesh.
static const closed_form forms[] = {
    { "fall of a cloth in 0.5 s, m", closed_fall, 0.5, 0.0, SUBSTEPS, { 1, 2, 5, 20, 80, 320 }, 6, 1.0 },
    { "angular momentum of a cloth after 0.5 s, N m s",
      closed_spin,
      0.5,
      0.0,
      SUBSTEPS,
      { 5, 10, 20, 40, 80 },
      5,
      1.0 },
    { "falling plate after 0.1 s, m/s", closed_plate, 0.1, 0.0, SUBSTEPS, { 1, 2, 5, 10, 20 }, 5, 1.0 },
    { "terminal velocity of a plate, m/s", closed_plate, 1.0, 0.0, SUBSTEPS, { 1, 2, 5, 10, 20 }, 5, 1.0 },
    { "sliding, 20 deg, mu 0.2, m", closed_slide, 20.0, 0.2, SUBSTEPS, { 1, 2, 5, 10, 20 }, 5, 1.0 },
    { "sliding, 40 deg, mu 0.5, m", closed_slide, 40.0, 0.5, SUBSTEPS, { 1, 2, 5, 10, 20 }, 5, 1.0 },
    { "sticking, 11 deg, mu 0.2, m", closed_slide, 11.0, 0.2, SUBSTEPS, { 20 }, 1, NAN },
    { "sticking, 26 deg, mu 0.5, m", closed_slide, 26.0, 0.5, SUBSTEPS, { 20 }, 1, NAN },
    { "elastic bar under its weight, m", closed_bar, 16.0, 0.0, SUBSTEPS, { 5, 10, 20, 40, 80 }, 5, 2.0 },
    { "elastic bar by iterations, m", closed_bar, 16.0, 10.0, ITERATIONS, { 1, 4, 16, 64 }, 4, NAN },
    { "sag of a catenary, m", closed_catenary, 32.0, 0.0, SUBSTEPS, { 5, 10, 20, 40, 80 }, 5, 2.0 },
    { "elastica, G = 1, drop / L", closed_elastica, 1.0, 0.12347140, CELLS, { 24 }, 1, NAN },
    { "elastica, G = 10, drop / L", closed_elastica, 10.0, 0.70019972, CELLS, { 3, 6, 12, 24 }, 4, 2.0 },
    { "lift of 0.14 m of helium, N", closed_lift, 0.14, 0.0, LEVEL, { 0, 1, 2, 3, 4 }, 5, 2.0 },
    { "sphere stretched by 5 %, 2 sigma / R, Pa", closed_sphere, 0.05, 0.0, LEVEL, { 0, 1, 2, 3, 4 }, 5, NAN },
    { "gas through an outlet in 0.2 s, m3", closed_emptying, 0.2, 0.0, SUBSTEPS, { 50, 100, 200, 400, 800 }, 5, 2.0 },
};

typedef struct closed_setting
{
    const closed_form* form;
    int value;
} closed_setting;

// ---- a run ----

static wisp_status run( void* context, int index, int workers, bool is_observed, accuracy_run* out,
                        wisp_error* error )
{
    const closed_setting* what = (const closed_setting*)context + index;
    closed_run run = { .first = what->form->first,
                       .second = what->form->second,
                       .parameter = what->value,
                       .workers = workers,
                       .is_observed = is_observed,
                       .out = out,
                       .momentum_error = NAN,
                       .strain = NAN };
    wisp_status status = what->form->run( &run, error );
    if ( status == WISP_OK && is_observed && out->halted_at == 0 )
    {
        // an error below a float's resolution counts as zero
        const double wrong =
            fabs( ( run.measured - run.reference ) / ( run.scale != 0.0 ? run.scale : run.reference ) );
        out->error = wrong < MIN_ERROR ? 0.0 : 100.0 * wrong;
        out->measures[0] = run.measured;
        out->measures[1] = run.reference;
        out->measures[2] = 100.0 * run.strain;
        out->measures[3] = 100.0 * run.momentum_error;
    }
    return status;
}

// ---- settings ----

static double parameter_of( closed_parameter parameter, int value )
{
    switch ( parameter )
    {
        case SUBSTEPS:
            return (double)ACCURACY_FRAME / value;
        case ITERATIONS:
            return 1.0 / value;
        case CELLS:
            return closed_strip_cell( value );
        default:
            return closed_sphere_edge( value );
    }
}

static void add( accuracy_scene* scene, const closed_form* form, int value )
{
    static const char* const names[] = { "substep, s", "1 / iterations", "cell, m", "edge / R" };
    closed_setting* settings = scene->context;
    settings[scene->setting_count] = ( closed_setting ){ form, value };
    static const char* const units[] = { "substeps", "iterations", "cells", "level" };
    accuracy_setting* setting = accuracy_put_setting( scene, "%s, %s %d", form->name, units[form->parameter], value );
    accuracy_join_series( setting, form->value_count > 1 ? form->name : "", names[form->parameter],
                          parameter_of( form->parameter, value ), form->order );
}

wisp_status accuracy_closed_forms( const bench_options* options, double seconds, accuracy_scene* out,
                                   wisp_error* error )
{
    (void)options;
    (void)seconds; // small bodies: a few seconds for all
    *out = ( accuracy_scene ){
        .reference = "the closed form of its series",
        .note = "each series is a separate experiment. With one iteration per substep, hanging bodies are softer "
                "than their compliance by h^2 k / m. The sphere converges to another value: its triangles never "
                "become equilateral.",
        .has_no_rivals = true,
        .error_name = "distance to the closed form",
        .error_unit = "%",
        .measure_names = { "measured", "closed form", "largest strain %", "momentum error %" },
        .measure_count = 4,
        .settings = calloc( SETTINGS_MAX, sizeof( accuracy_setting ) ),
        .context = calloc( SETTINGS_MAX, sizeof( closed_setting ) ),
        .run = run,
        .destroy = free,
    };
    if ( !out->settings || !out->context )
    {
        free( out->settings );
        free( out->context );
        *out = ( accuracy_scene ){ .setting_count = 0 };
        return wisp_fail( error, WISP_NO_MEMORY, "no memory for the settings of closed_forms" );
    }
    for ( int f = 0; f < WISP_COUNT( forms ); ++f )
    {
        for ( int i = 0; i < forms[f].value_count; ++i )
        {
            add( out, &forms[f], forms[f].values[i] );
        }
    }
    return WISP_OK;
}
