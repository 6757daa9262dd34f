// Hair on a head that is shaken: guides that move, ghosts that follow them, and what is read of both.
//
//     cc -std=c17 hair.c $(pkg-config --cflags --libs wisp) -o hair && ./hair
//
// Prints a line a second; exit status 0 if all is as it should be, 1 if not.
#include <wisp/guide_hair.h>
#include <wisp/strands.h>
#include <wisp/wisp.h>

#include <math.h>
#include <stdio.h>

#define GUIDES 16
#define GHOSTS 8 // around each guide
#define VERTICES 20
#define LENGTH 0.2f
#define STEP ( 1.0f / 60.0f )

static wisp_vec3 points[GUIDES * GHOSTS * VERTICES];
static int32_t offsets[GUIDES * GHOSTS + 1];

// Strands that hang from a circle of 8 cm; several about the same place lie 2 mm apart.
static void make_strands( int around )
{
    for ( int s = 0; s < GUIDES * around; ++s )
    {
        const float angle = 6.2831853f * (float)( s / around ) / GUIDES, aside = 0.002f * (float)( s % around );
        for ( int i = 0; i < VERTICES; ++i )
        {
            const float down = LENGTH * (float)i / ( VERTICES - 1 );
            points[s * VERTICES + i] =
                ( wisp_vec3 ){ ( 0.08f + aside ) * cosf( angle ), -down, ( 0.08f + aside ) * sinf( angle ) };
        }
        offsets[s + 1] = ( s + 1 ) * VERTICES;
    }
}

static wisp_status add_strands( wisp_world* world, int around, wisp_entity* out )
{
    wisp_strands_def def = wisp_default_strands_def();
    make_strands( around );
    def.points = points;
    def.offsets = offsets;
    def.strand_count = GUIDES * around;
    return wisp_add_strands( world, &def, out );
}

static wisp_status add_hair( wisp_world* world, wisp_entity* guides, wisp_entity* ghosts )
{
    const wisp_strand_dynamics_def dynamics = wisp_default_strand_dynamics_def();
    wisp_ghosts_def follow = wisp_default_ghosts_def();
    wisp_status status = add_strands( world, 1, guides );
    status = status == WISP_OK ? wisp_set_strand_dynamics( world, *guides, &dynamics ) : status;
    status = status == WISP_OK ? add_strands( world, GHOSTS, ghosts ) : status;
    follow.targets = *guides;
    status = status == WISP_OK ? wisp_set_ghosts( world, *ghosts, &follow ) : status;
    // asking creates the passes
    status = status == WISP_OK ? wisp_request( world, *guides, WISP_MOTION_STATS ) : status;
    return status == WISP_OK ? wisp_request( world, *ghosts, WISP_STRAND_POINTS ) : status;
}

// From side to side, twice a second.
static wisp_transform head_at( float time )
{
    const float turn = 0.4f * sinf( 12.566f * time );
    return wisp_transform_make( ( wisp_quat ){ 0.0f, sinf( 0.5f * turn ), 0.0f, cosf( 0.5f * turn ) },
                                ( wisp_vec3 ){ 0.0f, 0.0f, 0.0f } );
}

static wisp_status shake( wisp_world* world, wisp_entity guides, int seconds )
{
    wisp_status status = WISP_OK;
    for ( int step = 1; step <= 60 * seconds && status == WISP_OK; ++step )
    {
        status = wisp_move_strand_head( world, guides, head_at( STEP * (float)step ) );
        status = status == WISP_OK ? wisp_world_step( world, STEP ) : status;
        wisp_motion_stats motion_stats;
        if ( step % 60 == 0 && status == WISP_OK )
        {
            status = wisp_read_motion_stats( world, guides, &motion_stats );
            printf( "%d s: %5.2f m/s at most, longest stretch %.5f %%\n", step / 60, motion_stats.speed_max,
                    100.0 * motion_stats.strain_max );
        }
    }
    return status;
}

// Every ghost is still about as long as it was, and where its root is.
static int ghosts_hang( wisp_world* world, wisp_entity ghosts )
{
    wisp_view view;
    if ( wisp_world_view( world, ghosts, WISP_STRAND_POINTS, &view ) != WISP_OK )
    {
        return 0;
    }
    const wisp_vec3* p = view.data;
    for ( int s = 0; s < GUIDES * GHOSTS; ++s, p += VERTICES )
    {
        const wisp_vec3 tip = p[VERTICES - 1];
        const float reach = sqrtf( ( tip.x - p->x ) * ( tip.x - p->x ) + ( tip.y - p->y ) * ( tip.y - p->y ) +
                                   ( tip.z - p->z ) * ( tip.z - p->z ) );
        if ( !( reach > 0.5f * LENGTH && reach < 1.2f * LENGTH ) )
        {
            return 0;
        }
    }
    return 1;
}

int main( void )
{
    const wisp_module* const modules[] = { &wisp_strands_module, &wisp_guide_hair_module };
    wisp_world_def def = wisp_default_world_def();
    wisp_error error = { 0 };
    def.modules = modules;
    def.module_count = WISP_COUNT( modules );
    def.substeps = 8;
    wisp_world* world;
    if ( wisp_world_create( &def, &world, &error ) != WISP_OK )
    {
        fprintf( stderr, "hair: %s\n", error.message );
        return 1;
    }
    wisp_entity guides, ghosts;
    wisp_status status = add_hair( world, &guides, &ghosts );
    status = status == WISP_OK ? shake( world, guides, 3 ) : status;
    int good = status == WISP_OK && ghosts_hang( world, ghosts );
    if ( good == 0 )
    {
        fprintf( stderr, "hair: %s\n",
                 status == WISP_OK ? "ghosts are not where they should be" : wisp_world_message( world ) );
    }
    wisp_world_destroy( world );
    return good ? 0 : 1;
}
