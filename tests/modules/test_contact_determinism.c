// The same bits for any number of workers, any instruction set and any loop of the host, after a snapshot and in
// another world, and the same as in data/golden/contact.hash. WISP_GOLDEN=write in the environment rewrites that
// file.
#include "contact_fixture.h"
#include "determinism_fixture.h"

enum
{
    MAX_PARTICIPANTS = 3,
    STEPS = 24,
};

typedef enum case_kind
{
    FOLD,     // two cloths on a ball that moves
    BALLOONS, // three in a heap on a floor
    TANGLED,  // two cloths that start crossed
    THREADS,  // strands on cloth
    SOLVED,   // implicit cloths, Euler and BDF2, on a ball that moves
} case_kind;

typedef struct golden_case
{
    const char* name;
    case_kind kind;
    wisp_contact_level level;
    int iterations;
} golden_case;

static const golden_case cases[] = {
    { "fold", FOLD, WISP_CONTACT_EXACT, 1 },
    { "balloons", BALLOONS, WISP_CONTACT_EXACT, 2 },
    { "tangled", TANGLED, WISP_CONTACT_EXACT, 1 },
    { "strands", THREADS, WISP_CONTACT_EXACT, 1 },
    { "implicit", SOLVED, WISP_CONTACT_EXACT, 1 },
    { "spheres", FOLD, WISP_CONTACT_SPHERES, 1 },
    { "sphere_strands", THREADS, WISP_CONTACT_SPHERES, 1 },
};

typedef struct running
{
    determinism_run base;
    const golden_case* c;
    hosted h;
    wisp_entity participants[MAX_PARTICIPANTS], ball;
    int participant_count;
    double impulse; // of all steps
} running;

// @param integrator of implicit cloth
static void add_sheet( running* r, test_mesh* mesh, wisp_integrator integrator )
{
    wisp_entity* e = r->participants + r->participant_count++;
    if ( r->c->kind == FOLD )
    {
        *e = add_draping( r->h.world, mesh, NULL, 0, EARTH );
        return;
    }
    *e = add_mesh( r->h.world, mesh, NULL, 0, 0.15f );
    wisp_implicit_cloth_def def = wisp_default_implicit_cloth_def();
    def.integrator = integrator;
    assert_status( r->h.world, wisp_set_implicit_cloth( r->h.world, *e, &def ), WISP_OK );
    assert_status( r->h.world, wisp_set_gravity( r->h.world, *e, EARTH ), WISP_OK );
}

static void add_fold( running* r )
{
    test_mesh mesh = level_sheet( 17, 0.6f, ( wisp_vec3 ){ 0.02f, 0.2f, 0.01f } );
    test_mesh upper = level_sheet( 11, 0.5f, ( wisp_vec3 ){ 0.0f, 0.22f, 0.03f } );
    add_sheet( r, &mesh, WISP_INTEGRATOR_EULER );
    add_sheet( r, &upper, WISP_INTEGRATOR_BDF2 );
    wisp_collider_def ball = wisp_default_collider_def();
    ball.kind = WISP_COLLIDER_SPHERE;
    ball.radius = 0.08f;
    ball.pose.translation = ( wisp_vec3 ){ 0.0f, 0.1f, 0.0f };
    assert_status( r->h.world, wisp_add_collider( r->h.world, &ball, &r->ball ), WISP_OK );
    add_floor( r->h.world, ( wisp_vec3 ){ 0 }, ( wisp_vec3 ){ 0.0f, 1.0f, 0.0f } );
    set_collision( r->h.world, r->participants[0] );
}

static void add_heap( running* r )
{
    add_floor( r->h.world, ( wisp_vec3 ){ 0 }, ( wisp_vec3 ){ 0.0f, 1.0f, 0.0f } );
    for ( int k = 0; k < MAX_PARTICIPANTS; ++k )
    {
        test_mesh mesh =
            ball_of( 2, 0.1f, ( wisp_vec3 ){ 0.09f * (float)k, 0.11f + 0.15f * (float)( k % 2 ), 0.0f } );
        r->participants[r->participant_count++] = add_balloon( r->h.world, &mesh, EARTH );
        set_collision( r->h.world, r->participants[k] );
    }
}

static void add_tangle( running* r )
{
    for ( int k = 0; k < 2; ++k )
    {
        test_mesh mesh = level_sheet( 9, 0.5f, ( wisp_vec3 ){ 0 } );
        for ( int v = 0; v < mesh.vertex_count && k == 1; ++v )
        {
            const wisp_vec3 p = mesh.points[v];
            mesh.points[v] = ( wisp_vec3 ){ 0.9f * p.x + 0.013f, p.z + 0.2f, 0.017f };
        }
        const int32_t corners[4] = { 80, 72, 0, 8 };
        r->participants[r->participant_count++] = add_draping( r->h.world, &mesh, corners, k == 0 ? 4 : 2, EARTH );
    }
}

static void add_threads( running* r )
{
    test_mesh mesh = level_sheet( 9, 0.4f, ( wisp_vec3 ){ 0 } );
    const int32_t corners[4] = { 0, 8, 72, 80 };
    r->participants[r->participant_count++] = add_draping( r->h.world, &mesh, corners, 4, EARTH );
    const wisp_entity e = test_add_strands( r->h.world, 10, 12 ); // upwards from 0.1 m, so they fall over
    SET( r->h.world, e, strand_dynamics, d.damping = 0.0f );
    assert_status( r->h.world, wisp_request( r->h.world, e, WISP_STRAND_POINTS ), WISP_OK );
    const wisp_transform down = { { 0.0f, 0.0f, 1.0f, 0.0f }, { 0.0f, 0.2f, 0.0f } };
    assert_status( r->h.world, wisp_move_strand_head( r->h.world, e, down ), WISP_OK );
    r->participants[r->participant_count++] = e;
}

static void add_case( running* r )
{
    switch ( r->c->kind )
    {
        case FOLD:
        case SOLVED:
            add_fold( r );
            break;
        case BALLOONS:
            add_heap( r );
            break;
        case TANGLED:
            add_tangle( r );
            break;
        default:
            add_threads( r );
            break;
    }
    wisp_contact_settings settings = wisp_default_contact_settings();
    settings.level = r->c->level;
    assert_status( r->h.world, wisp_set_contact_settings( r->h.world, &settings ), WISP_OK );
    const wisp_contact_def def = wisp_default_contact_def();
    for ( int k = 0; k < r->participant_count; ++k )
    {
        set_contact( r->h.world, r->participants[k], &def );
    }
    request_stats( r->h.world );
}

static void run_case_steps( determinism_run* base, int steps )
{
    running* r = (running*)base;
    for ( int i = 0; i < steps; ++i )
    {
        r->base.steps += 1;
        const float t = FRAME * (float)r->base.steps;
        const wisp_transform pose = { { 0.0f, 0.0f, 0.0f, 1.0f }, { 0.4f * t, 0.1f, -0.2f * t } };
        if ( r->c->kind == FOLD || r->c->kind == SOLVED )
        {
            assert_status( r->h.world, wisp_move_collider( r->h.world, r->ball, pose ), WISP_OK );
        }
        run_steps( r->h.world, 1, FRAME );
        r->impulse += contact_stats( r->h.world ).impulse;
    }
}

static determinism_run* open_case( int number, const place_to_run* place, int* calls )
{
    running* r = checked_calloc( 1, sizeof( *r ) );
    r->c = cases + number;
    r->h.def = contact_world_def( &r->h );
    determinism_place( &r->h.def, place, calls );
    r->h.def.substeps = 6;
    r->h.def.iterations = r->c->iterations;
    assert_int_equal( wisp_world_create( &r->h.def, &r->h.world, NULL ), WISP_OK );
    r->base = ( determinism_run ){ number, 0, r->h.world, &r->h.host };
    add_case( r );
    return &r->base;
}

static void close_case( determinism_run* base )
{
    close_world( &( (running*)base )->h );
    free( base );
}

static traces traces_of( determinism_run* base )
{
    running* r = (running*)base;
    traces t = { 0, wisp_world_hash( r->h.world ) };
    for ( int k = 0; k < r->participant_count; ++k )
    {
        const bool strands = r->c->kind == THREADS && k == 1;
        t.motion = 31 * t.motion +
                   hash_of( r->h.world, r->participants[k], strands ? WISP_STRAND_POINTS : WISP_SURFACE_POINTS );
    }
    return t;
}

static void check_case( determinism_run* base )
{
    if ( !( ( (running*)base )->impulse > 0.0 ) )
    {
        fail_msg( "nothing pressed in %s", cases[base->number].name );
    }
}

static void nudge( determinism_run* base )
{
    velocity_of( base->world, ( (running*)base )->participants[0], 20 )[2] += 1e-3f;
}

// Lists of pairs grow with the pairs found, so the same motion runs twice: memory that was enough once is enough
// again.
static determinism_case describe( int number )
{
    return ( determinism_case ){ cases[number].name, STEPS, .warm_workers = 1, .rehearsal = STEPS };
}

DETERMINISM( contact, false );
