// The points of boundary layers are those of
// data/golden/boundary.hash. WISP_GOLDEN=write in the environment rewrites that file.
#include "boundary_fixture.h"
#include "golden_file.h"

static const char* const golden_file = WISP_SOURCE_ROOT "/data/golden/boundary.hash";

typedef struct golden_case
{
    const char* name;
    int level; // of the ball: 4 is enough for several workers in every stage
    float spacing;
    wisp_spacing policy;
    wisp_rounding rounding;
    float hysteresis, curvature_gain, strain_gain;
    bool by_distance;
} golden_case;

static const golden_case CASES[] = {
    { "even", 3, 0.04f, WISP_SPACING_EVEN, WISP_ROUND_DOWN, 0.0f, 0.0f, 0.0f, false },
    { "even-up-fine", 4, 0.02f, WISP_SPACING_EVEN, WISP_ROUND_UP, 0.0f, 0.0f, 0.0f, false },
    { "even-nearest", 3, 0.04f, WISP_SPACING_EVEN, WISP_ROUND_NEAREST, 0.0f, 0.0f, 0.0f, false },
    { "exact", 3, 0.04f, WISP_SPACING_EXACT, WISP_ROUND_DOWN, 0.0f, 0.0f, 0.0f, false },
    { "exact-steady", 4, 0.03f, WISP_SPACING_EXACT, WISP_ROUND_DOWN, 0.3f, 0.0f, 0.0f, false },
    { "local", 3, 0.05f, WISP_SPACING_EVEN, WISP_ROUND_DOWN, 0.1f, 2.0f, 3.0f, true },
    { "local-coarser", 3, 0.03f, WISP_SPACING_EVEN, WISP_ROUND_DOWN, 0.0f, 0.0f, -5.0f, false },
};

static uint64_t hash_case( const golden_case* c )
{
    SCOPED( ball_close ) ball_world* b = ball_open( c->level, 1, NULL );
    wisp_boundary_def def = ball_layer( c->spacing );
    def.policy = c->policy;
    def.rounding = c->rounding;
    def.hysteresis = c->hysteresis;
    def.curvature_gain = c->curvature_gain;
    def.strain_gain = c->strain_gain;
    def.eye = ( wisp_vec3 ){ 2.0f, 1.0f, 4.0f };
    def.eye_angle = c->by_distance ? 4.0f * 4e-3f : 0.0f;
    set_layer( b, b->ball, &def );
    uint64_t hash = 0;
    for ( int i = 0; i < 8; ++i )
    {
        ball_steps( b, 1 );
        hash = hash * 31u + layer_hash( b, b->ball );
    }
    return hash;
}

static golden_hash run_numbered( int number, const void* context )
{
    (void)context;
    return ( golden_hash ){ CASES[number].name, hash_case( CASES + number ) };
}

TEST( layers_are_those_of_the_golden_file )
{
    golden_check( golden_file, WISP_COUNT( CASES ), true, run_numbered, NULL );
}
