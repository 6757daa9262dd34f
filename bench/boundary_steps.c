// Measure the balloon with a layer, by stiffness, step and gravity.
#include "boundary_bench.h"

#include "oracle/boundary_oracle.h"

#include <math.h>

// Tolerance of the volume of a soft skin against that of its gas.
static const double SOFT_TOLERANCE = 0.02;
static const float SOFT_SKIN = 0.01f;

typedef struct sphere
{
    wisp_mesh mesh;
    wisp_fabric* fabric;
} sphere;

static wisp_status make_sphere( sphere* out, wisp_error* error )
{
    *out = ( sphere ){ 0 };
    wisp_status status = layer_sphere( LAYER_SEGMENTS, LAYER_RADIUS, &out->mesh, error );
    return status == WISP_OK ? layer_cook( &out->mesh, &out->fabric, error ) : status;
}

static void free_sphere( sphere* s )
{
    wisp_fabric_release( s->fabric );
    wisp_mesh_release( &s->mesh );
}

// ---- volume by stiffness ----

// The same balloon in double; its distances are in the order of the paper, Wisp's in colours.
static double oracle_volume( const layer_balloon* setting, int steps )
{
    balloon_mesh mesh;
    boundary_oracle_balloon balloon;
    double volume = NAN;
    if ( !boundary_oracle_sphere( &mesh, LAYER_SEGMENTS, LAYER_SEGMENTS, (double)LAYER_RADIUS ) )
    {
        return NAN;
    }
    if ( boundary_oracle_balloon_create( &mesh, &balloon ) )
    {
        balloon.options.distance_k = (double)setting->skin;
        balloon.options.multiplier = (double)setting->multiplier;
        for ( int s = 0; s < steps; ++s )
        {
            boundary_oracle_balloon_step( &balloon, (double)setting->seconds );
        }
        volume = boundary_oracle_balloon_volume( &balloon ) / balloon.rest_volume;
        boundary_oracle_balloon_destroy( &balloon );
    }
    balloon_mesh_destroy( &mesh );
    return volume;
}

static wisp_status run_volume( const boundary_plan* plan, const sphere* s, const layer_balloon* setting, int table,
                               results* out, wisp_error* error )
{
    surface_implementation balloon = { 0 };
    double reached = NAN;
    wisp_status status = layer_enter_balloon( s->fabric, &s->mesh, setting, &balloon, error );
    for ( int step = 0; step < plan->settle_steps && status == WISP_OK; ++step )
    {
        status = surface_implementation_step( &balloon, error );
    }
    status = status == WISP_OK ? layer_volume( &balloon, &s->mesh, &reached, error ) : status;
    const bool halted = balloon.halted_at > 0;
    surface_implementation_destroy( &balloon );
    if ( status != WISP_OK )
    {
        return status;
    }
    const double off = reached / (double)setting->multiplier - 1.0;
    const bool soft = setting->skin == SOFT_SKIN;
    const bool met = !halted && isfinite( off ) && ( !soft || fabs( off ) < SOFT_TOLERANCE );
    cells row = { .count = 0 };
    cells_put( &row, "%s", soft ? "soft" : "paper" );
    cells_put_number( &row, (double)setting->skin, 2 );
    cells_put_number( &row, (double)setting->multiplier, 1 );
    cells_put_number( &row, reached, 4 );
    cells_put_number( &row, 100.0 * off, 2 );
    cells_put_number( &row, oracle_volume( setting, plan->settle_steps ), 4 );
    cells_put( &row, "%s", soft ? "within 2 %" : "is reported" );
    cells_put( &row, "%s", met ? "yes" : "NO" );
    cells_end_row( &row, table, out );
    results_row* line = results_add_row( out, "boundary", soft ? "volume, soft" : "volume, source" );
    if ( line != NULL )
    {
        line->workers = 1;
        line->steps = plan->settle_steps;
        results_put( &line->size, "multiplier", (double)setting->multiplier );
        snprintf( line->error_reference, sizeof( line->error_reference ), "multiplier" );
        results_put( &line->error, "volume", off );
    }
    if ( !met )
    {
        results_add_failure( out, "Volume: with stiffness %g the multiplier %g gave %.4f rest volumes.",
                             (double)setting->skin, (double)setting->multiplier, reached );
    }
    return WISP_OK;
}

wisp_status boundary_volumes( const boundary_plan* plan, results* out, wisp_error* error )
{
    static const char* const header[] = { "skin",     "stiffness", "multiplier", "V / V_rest",
                                          "error, %", "oracle",    "expected",   "met" };
    static const float multipliers[] = { 0.5f, 1.0f, 2.0f, 3.0f };
    char title[160];
    snprintf( title, sizeof( title ), "Volume: rest volumes reached by each multiplier after %d steps of 1/60 s",
              plan->settle_steps );
    const int table = results_add_table( out, title, WISP_COUNT( header ), header );
    sphere s;
    wisp_status status = make_sphere( &s, error );
    for ( int i = 0; i < 2 * WISP_COUNT( multipliers ) && status == WISP_OK; ++i )
    {
        layer_balloon setting = layer_default_balloon();
        setting.skin = i < WISP_COUNT( multipliers ) ? SOFT_SKIN : LAYER_SKIN;
        setting.multiplier = multipliers[i % WISP_COUNT( multipliers )];
        status = run_volume( plan, &s, &setting, table, out, error );
    }
    free_sphere( &s );
    return status;
}

// ---- long steps and strong gravity ----

typedef struct hang
{
    uint64_t hash;
    double volume_error; // the largest of all steps
    double height;       // m, at the end
    int halted_at;
    bool is_finite;
} hang;

static void observe( surface_implementation* balloon, const wisp_mesh* mesh, const wisp_vec3* points, hang* out )
{
    float lower = INFINITY, upper = -INFINITY;
    out->is_finite = surface_implementation_observe( balloon ).is_finite;
    for ( int v = 0; v < mesh->vertex_count; ++v )
    {
        lower = fminf( lower, points[v].y );
        upper = fmaxf( upper, points[v].y );
    }
    out->height = (double)upper - (double)lower;
    out->halted_at = balloon->halted_at;
}

static wisp_status run_hang( const sphere* s, const layer_balloon* setting, int steps, bool has_layer, hang* out,
                             wisp_error* error )
{
    *out = ( hang ){ 0 };
    surface_implementation balloon = { 0 };
    const wisp_boundary_def def = layer_def( &layer_laws[0], LAYER_SPACING );
    wisp_status status = layer_enter_balloon( s->fabric, &s->mesh, setting, &balloon, error );
    status = status == WISP_OK && has_layer ? layer_set( &balloon, &def, error ) : status;
    for ( int step = 0; step < steps && status == WISP_OK; ++step )
    {
        double volume = NAN;
        status = surface_implementation_step( &balloon, error );
        status = status == WISP_OK ? layer_volume( &balloon, &s->mesh, &volume, error ) : status;
        const double off = fabs( volume / (double)setting->multiplier - 1.0 );
        out->volume_error = off > out->volume_error || isnan( off ) ? off : out->volume_error;
    }
    const wisp_vec3* points = NULL;
    status = status == WISP_OK ? surface_implementation_points( &balloon, &points, error ) : status;
    if ( status == WISP_OK )
    {
        observe( &balloon, &s->mesh, points, out );
        status = surface_implementation_hash( &balloon, &out->hash, error );
    }
    surface_implementation_destroy( &balloon );
    return status;
}

static void add_hang( const layer_balloon* setting, int steps, const hang* with, const hang* without, int table,
                      results* out )
{
    const bool same = with->hash == without->hash;
    const bool is_finite = with->is_finite && isfinite( with->volume_error ) && with->halted_at == 0;
    const int rate = (int)lround( 1.0 / (double)setting->seconds );
    cells row = { .count = 0 };
    cells_put( &row, "1/%d", rate );
    cells_put_number( &row, (double)setting->gravity, 2 );
    cells_put( &row, "%d", steps );
    cells_put_number( &row, 100.0 * with->volume_error, 4 );
    cells_put_number( &row, with->height, 3 );
    cells_put( &row, "%s", is_finite ? "yes" : "NO" );
    cells_put( &row, "%s", same ? "yes" : "NO" );
    cells_put_hash( &row, with->hash );
    cells_end_row( &row, table, out );
    results_row* line = results_add_row( out, "boundary", "hang" );
    if ( line != NULL )
    {
        line->workers = 1;
        line->steps = steps;
        line->hash = with->hash;
        line->has_hash = true;
        results_put( &line->size, "steps_per_second", rate );
        results_put( &line->size, "gravity", (double)setting->gravity );
        snprintf( line->error_reference, sizeof( line->error_reference ), "volume of the gas" );
        results_put( &line->error, "volume", with->volume_error );
    }
    if ( !is_finite || !same )
    {
        results_add_failure( out, "Long steps: at %d steps per second and %g m/s^2 the balloon %s.", rate,
                             (double)setting->gravity,
                             same ? "did not stay finite" : "has other positions with a layer than without" );
    }
}

wisp_status boundary_steps( const boundary_plan* plan, results* out, wisp_error* error )
{
    static const char* const header[] = {
        "dt", "gravity", "steps", "max volume error, %", "height, m", "finite", "same without a layer", "hash"
    };
    static const int rates[] = { 240, 120, 60, 30, 20 };
    static const float gravities[] = { 0.98f, 9.8f, 98.0f };
    char title[160];
    snprintf(
        title, sizeof( title ),
        "Long steps: the reference sphere hung by its top for %.1f s, by step and gravity, with and without a layer",
        plan->hang_seconds );
    const int table = results_add_table( out, title, WISP_COUNT( header ), header );
    sphere s;
    wisp_status status = make_sphere( &s, error );
    for ( int i = 0; i < WISP_COUNT( rates ) * WISP_COUNT( gravities ) && status == WISP_OK; ++i )
    {
        layer_balloon setting = layer_default_balloon();
        const int rate = rates[i % WISP_COUNT( rates )], steps = (int)ceil( plan->hang_seconds * rate );
        setting.is_hung = true;
        setting.seconds = 1.0f / (float)rate;
        setting.gravity = gravities[i / WISP_COUNT( rates )];
        hang with, without;
        status = run_hang( &s, &setting, steps, true, &with, error );
        status = status == WISP_OK ? run_hang( &s, &setting, steps, false, &without, error ) : status;
        if ( status == WISP_OK )
        {
            add_hang( &setting, steps, &with, &without, table, out );
        }
    }
    free_sphere( &s );
    results_add_note(
        out,
        "Long steps: stiffness without units depends on the step, so the sag differs. The boundary particle paper "
        "claims that the sphere stays finite and keeps its volume; its own program switches gravity off." );
    return status;
}
