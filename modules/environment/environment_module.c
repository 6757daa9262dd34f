#include "environment.h"

#include "wisp/module/components.h"
#include "wisp/module/module.h"

#include <math.h>

static const wisp_column_def SETTINGS_COLUMNS[] = { WISP_COLUMN( wisp_environment_def, settings, 1 ) };

typedef struct environment_state
{
    wisp_component settings;
} environment_state;

static const wisp_field ENVIRONMENT_FIELDS[] = {
    WISP_NUMBER( wisp_environment_def, temperature_celsius, -10, -273.15, 1000, "degrees Celsius" ),
    WISP_NUMBER( wisp_environment_def, wetness, 1, 0, 1, NULL ),
    WISP_NUMBER( wisp_environment_def, freezing_celsius, 0, -273.15, 1000, "degrees Celsius" ),
    WISP_NUMBER( wisp_environment_def, span, 10, 1e-3, 1000, "K" ),
    WISP_WHOLE( wisp_environment_def, point_count, 2, 2, WISP_ENVIRONMENT_MAX_POINTS ),
    WISP_NUMBER( wisp_environment_def, ice[1], 1, 0, 1, NULL ),
    WISP_NUMBER( wisp_environment_def, stiffness[0], 1, 1e-3, 1e12, NULL ),
    WISP_NUMBER( wisp_environment_def, stiffness[1], 20, 1e-3, 1e12, NULL ),
};
WISP_DEFINE( environment_def, "environment", ENVIRONMENT_FIELDS )

// ---- the curve ----

static float secant( const wisp_environment_def* d, int i )
{
    return ( d->stiffness[i + 1] - d->stiffness[i] ) / ( d->ice[i + 1] - d->ice[i] );
}

// Slope at a control point: the harmonic mean of its two secants, which keeps a cubic monotone (Fritsch and Butland
// 1984, the form of Fritsch and Carlson's condition without a second sweep); the ends take their only secant.
static float slope( const wisp_environment_def* d, int i )
{
    if ( i == 0 || i == d->point_count - 1 )
    {
        return secant( d, i == 0 ? 0 : i - 1 );
    }
    float a = secant( d, i - 1 ), b = secant( d, i );
    return a * b > 0.0f ? 2.0f * a * b / ( a + b ) : 0.0f;
}

static float curve_at( const wisp_environment_def* d, float ice )
{
    int i = 0;
    while ( i < d->point_count - 2 && ice > d->ice[i + 1] )
    {
        ++i;
    }
    float width = d->ice[i + 1] - d->ice[i];
    float t = ( ice - d->ice[i] ) / width;
    float k0 = d->stiffness[i], k1 = d->stiffness[i + 1];
    float m0 = slope( d, i ) * width, m1 = slope( d, i + 1 ) * width;

    // Hermite form from the left end; the clamp removes rounding beyond the ends
    float k = k0 + t * ( m0 + t * ( 3.0f * ( k1 - k0 ) - 2.0f * m0 - m1 + t * ( 2.0f * ( k0 - k1 ) + m0 + m1 ) ) );
    float lower = k0 < k1 ? k0 : k1, upper = k0 < k1 ? k1 : k0;
    return k < lower ? lower : ( k > upper ? upper : k );
}

static float stiffness_at( const wisp_environment_def* def, float temperature, float wetness )
{
    float t = ( def->freezing_celsius - temperature ) / def->span;
    t = t < 0.0f ? 0.0f : ( t > 1.0f ? 1.0f : t );
    return curve_at( def, wetness * ( t * t * ( 3.0f - 2.0f * t ) ) );
}

float wisp_environment_stiffness( const wisp_environment_def* given, float temperature, float wetness )
{
    wisp_environment_def def;
    return wisp_def_read( &wisp_environment_def_fields, &def, given, NULL ) == WISP_OK
               ? stiffness_at( &def, temperature, wetness )
               : 0.0f;
}

// ---- the pass ----

static void drive_stiffness( wisp_frame* frame, const wisp_span* span, void* user )
{
    const environment_state* state = user;
    const wisp_environment_def* d = wisp_frame_column( frame, span->entity, state->settings, 0 );
    float* stretch = wisp_frame_column( frame, span->entity, WISP_STRAND_STIFFNESS, 0 );
    float* bend = wisp_frame_column( frame, span->entity, WISP_STRAND_STIFFNESS, 1 );
    float k = stiffness_at( d, d->temperature_celsius, d->wetness );
    for ( int i = span->begin * WISP_LANES; i < span->end * WISP_LANES; ++i )
    {
        stretch[i] = bend[i] = k;
    }
}

static wisp_status declare( wisp_registry* r )
{
    environment_state* state = wisp_declare_state( r, sizeof( environment_state ) );
    if ( state == NULL )
    {
        return WISP_NO_MEMORY;
    }
    state->settings = WISP_COMPONENT( r, "environment.settings", WISP_TABLE_ENTITY, SETTINGS_COLUMNS );
    const wisp_index_range points =
        WISP_MEMBER_RANGE( state->settings, wisp_environment_def, point_count, 2, WISP_ENVIRONMENT_MAX_POINTS );
    WISP_TRY( wisp_declare_indices( r, &points, 1 ) );
    return wisp_declare_pass( r, &( wisp_pass ){
                                     WISP_PASS( "environment.stiffness", INPUT, STRAND_GROUP, drive_stiffness ),
                                     .required = { state->settings },
                                     .reads = { state->settings },
                                     .writes = { WISP_STRAND_STIFFNESS },
                                     .on_change = WISP_STRAND_STIFFNESS, // overrides any other writer
                                     .user = state,
                                 } );
}

const wisp_module wisp_environment_module = { .name = "environment", .declare = declare };

// ---- parameters ----

static wisp_status check_curve( wisp_world* world, const wisp_environment_def* d )
{
    for ( int i = 0; i < d->point_count; ++i )
    {
        if ( !( d->stiffness[i] >= 1e-3f && d->stiffness[i] <= 1e12f ) )
        {
            return wisp_world_fail( world, WISP_BAD_INPUT,
                                    "environment: stiffness of curve point %d: got %g, expected 0.001 to 1e12", i,
                                    (double)d->stiffness[i] );
        }
        bool rises = i == 0 ? d->ice[0] == 0.0f : d->ice[i] > d->ice[i - 1];
        if ( rises == false || ( i == d->point_count - 1 && d->ice[i] != 1.0f ) )
        {
            return wisp_world_fail(
                world, WISP_BAD_INPUT,
                "environment: ice of curve point %d: got %g, expected ascending values from 0 to 1", i,
                (double)d->ice[i] );
        }
    }
    float direction = 0.0f; // of the first segment that is not level
    for ( int i = 0; i + 1 < d->point_count; ++i )
    {
        float change = d->stiffness[i + 1] - d->stiffness[i];
        direction = direction == 0.0f ? change : direction;
        if ( ( change < 0.0f && direction > 0.0f ) || ( change > 0.0f && direction < 0.0f ) )
        {
            return wisp_world_fail( world, WISP_BAD_INPUT,
                                    "environment: stiffness of curve point %d: expected a monotone curve", i + 1 );
        }
    }
    return WISP_OK;
}

wisp_status wisp_set_environment( wisp_world* world, wisp_entity strands, const wisp_environment_def* given )
{
    wisp_environment_def values;
    const wisp_environment_def* def = &values;
    WISP_TRY( wisp_world_begin_def( world, &strands, &wisp_environment_def_fields, &values, given ) );
    WISP_FIND_STATE( const environment_state, state, world, "environment", &strands, WISP_IS_STRANDS );
    WISP_TRY( check_curve( world, def ) );
    const wisp_component_use uses[] = { { state->settings, true }, { WISP_STRAND_STIFFNESS, true } };
    WISP_TRY( wisp_world_set_components( world, strands, uses, WISP_COUNT( uses ) ) );
    *(wisp_environment_def*)wisp_world_column( world, strands, state->settings, 0 ) = *def;
    wisp_world_column( world, strands, WISP_STRAND_STIFFNESS,
                       0 ); // marks the column as written, so that the pass runs
    return WISP_OK;
}
