// Bending by curvature, solved implicitly once per substep: hinge after hinge, stiff bending would be as soft as the substeps are
// few. It changes velocities: in short substeps its moves are below the rounding of positions, and lost there. Equations:
// wisp/module/plate.h and docs/methods.md.

#include "cloth_internal.h"
#include "wisp/module/double3.h"

#include <float.h>
#include <math.h>

// ---- material ----

// From a definition to the coefficients of links and hinges, in the order of the fabric's schedules.

// Compliance of a constraint that must not act, m/N or 1/J.
static const float NOTHING = 1e12f;

static double3 rest_of( const wisp_fabric* f, int slot )
{
    return double3_widen( f->rest[slot] );
}

// ---- links ----

// Square of the cosine between a link of the rest shape and the warp.
static float cosine2( const wisp_fabric* f, int a, int b, wisp_vec3 warp )
{
    double3 d = double3_sub( rest_of( f, a ), rest_of( f, b ) ),
            w = { (double)warp.x, (double)warp.y, (double)warp.z };
    double bottom = double3_dot( d, d ) * double3_dot( w, w ), along = double3_dot( d, w );
    return bottom > 0.0 ? (float)( along * along / bottom ) : 1.0f;
}

static float stretch_compliance( const wisp_cloth_def* def, float c2 )
{
    float s2 = 1.0f - c2;
    return def->warp_compliance * c2 * c2 + def->weft_compliance * s2 * s2 + def->shear_compliance * s2 * c2;
}

// 4 sin^2 cos^2 is 0 along the threads and 1 between them.
static float stretch_stiffness( const wisp_cloth_def* def, float c2 )
{
    float between = 4.0f * c2 * ( 1.0f - c2 );
    return def->stretch_stiffness + between * ( def->shear_stiffness - def->stretch_stiffness );
}

static float link_value( const wisp_fabric* f, const wisp_cloth_def* def, int slot )
{
    const bool pbd = def->solver == WISP_SOLVER_PBD;
    const int kind = wisp_fabric_link_kind( f, slot );
    if ( kind < 0 )
    {
        return 0.0f;
    }
    if ( kind == 0 )
    {
        float c2 = cosine2( f, f->link_a_x4[slot] / 4, f->link_b_x4[slot] / 4, def->warp );
        return pbd ? stretch_stiffness( def, c2 ) : stretch_compliance( def, c2 );
    }
    // A bend link without bending must not stretch either: no stiffness, or a very large compliance.
    const bool bends = def->bending == WISP_CLOTH_BENDING_LINKS;
    return pbd ? ( bends ? def->bend_stiffness : 0.0f ) : ( bends ? def->bend_compliance : NOTHING );
}

bool cloth_find_alike( const wisp_fabric* f, const wisp_cloth_def* def, float alike[2] )
{
    bool are_alike = true;
    alike[0] = alike[1] = -1.0f;
    for ( int slot = 0; slot < f->link_order.slot_count && are_alike; ++slot )
    {
        const int kind = wisp_fabric_link_kind( f, slot );
        const float value = link_value( f, def, slot );
        if ( kind >= 0 )
        {
            are_alike = alike[kind] < 0.0f || alike[kind] == value;
            alike[kind] = value;
        }
    }
    alike[0] = are_alike ? alike[0] : -1.0f;
    return are_alike;
}

void cloth_fill_links( wisp_world* world, wisp_entity surface, const wisp_cloth_def* def )
{
    const wisp_fabric* f = wisp_world_fabric( world, surface );
    const bool pbd = def->solver == WISP_SOLVER_PBD;
    float* alike = wisp_world_column( world, surface, pbd ? WISP_LINK_STIFFNESS : WISP_LINK_COMPLIANCE, 0 );
    float* column = wisp_world_column( world, surface, WISP_LINK_OWN, 0 );
    if ( alike != NULL )
    {
        (void)cloth_find_alike( f, def, alike );
    }
    for ( int slot = 0; slot < f->link_order.slot_count && column != NULL; ++slot )
    {
        column[slot] = link_value( f, def, slot );
    }
}

// ---- coarse sheets ----

// Fills the links of all coarse sheets: each sheet is one of the same material, so its links have the same compliance.
void cloth_fill_levels( wisp_world* world, wisp_entity surface, const wisp_cloth_def* def )
{
    const wisp_fabric* f = wisp_world_fabric( world, surface );
    float* compliance = wisp_world_column( world, surface, WISP_LEVEL_COMPLIANCE, 0 );
    if ( compliance == NULL )
    {
        return;
    }
    *(int32_t*)wisp_world_column( world, surface, WISP_SURFACE_LEVELS, 0 ) = def->coarse_substeps;
    *(int32_t*)wisp_world_column( world, surface, WISP_SURFACE_LEVELS, 1 ) = def->coarse_passes;
    for ( int l = 0; l < f->level_count; ++l )
    {
        const wisp_fabric_level* level = f->levels + l;
        for ( int i = 0; i < level->schedule.slot_count; ++i )
        {
            const int a = level->slot_x4[level->a_x4[i] / 4] / 4, b = level->slot_x4[level->b_x4[i] / 4] / 4;
            const float fraction = level->fraction[i];
            compliance[level->first_link + i] =
                fraction > 0.0f ? stretch_compliance( def, cosine2( f, a, b, def->warp ) ) / fraction : 0.0f;
        }
    }
    wisp_world_restart_levels( world, surface );
}

// ---- hinges ----

typedef struct hinge_shape
{
    double3 i, j, k, l;
    double edge; // length, m
    bool sound;  // both triangles have an area, so there is an angle between them
} hinge_shape;

static hinge_shape shape_of( const wisp_fabric* f, int slot )
{
    int32_t corner[4];
    wisp_fabric_hinge_corners( f, slot, corner );
    hinge_shape s = {
        rest_of( f, corner[0] ), rest_of( f, corner[1] ), rest_of( f, corner[2] ), rest_of( f, corner[3] ), 0.0, false
    };
    double3 e = double3_sub( s.j, s.i );
    double k_area = 0.5 * double3_length( double3_cross( e, double3_sub( s.k, s.i ) ) );
    double l_area = 0.5 * double3_length( double3_cross( e, double3_sub( s.l, s.i ) ) );
    s.edge = double3_length( e );
    s.sound = k_area > 0.0 && l_area > 0.0;
    return s;
}

// The angle as the kernel measures it: positive where the opposite vertices lie on the side of the normals.
static float rest_angle( const hinge_shape* s )
{
    double3 e = double3_sub( s->j, s->i );
    double3 n1 = double3_cross( double3_sub( s->k, s->i ), double3_sub( s->k, s->j ) ),
            n2 = double3_cross( double3_sub( s->l, s->j ), double3_sub( s->l, s->i ) );
    double sine = s->edge > 0.0 ? double3_dot( double3_cross( n2, n1 ), e ) / s->edge : 0.0;
    return (float)atan2( sine, double3_dot( n1, n2 ) );
}

// Cotangent of the angle at `at` between the directions to a and b; 0 for a triangle without area.
static double cotangent( double3 at, double3 a, double3 b )
{
    double3 u = double3_sub( a, at ), v = double3_sub( b, at );
    double bottom = double3_length( double3_cross( u, v ) );
    return bottom > 0.0 ? double3_dot( u, v ) / bottom : 0.0;
}

// The row of Bergou et al. 2006, eq. 4: c . x is the edge's length times the bending, as a vector.
static void bending_row( const hinge_shape* s, double c[4] )
{
    double at_i_k = cotangent( s->i, s->j, s->k ), at_j_k = cotangent( s->j, s->i, s->k );
    double at_i_l = cotangent( s->i, s->j, s->l ), at_j_l = cotangent( s->j, s->i, s->l );
    c[0] = at_j_k + at_j_l;
    c[1] = at_i_k + at_i_l;
    c[2] = -( at_i_k + at_j_k );
    c[3] = -( at_i_l + at_j_l );
}

static void fill_shape( wisp_world* world, wisp_entity surface, const hinge_shape* s, const wisp_cloth_def* def,
                        int slot )
{
    if ( def->bending == WISP_CLOTH_BENDING_DIHEDRAL )
    {
        float* angle = wisp_world_column( world, surface, WISP_HINGE_REST, 0 );
        angle[slot] = s->sound ? rest_angle( s ) : 0.0f;
        return;
    }
    float* weight = wisp_world_column( world, surface, WISP_HINGE_COTANGENT, 0 );
    double c[4] = { 0 };
    if ( s->sound )
    {
        bending_row( s, c );
    }
    for ( int k = 0; k < 4; ++k )
    {
        weight[( slot / 8 ) * 32 + 8 * k + slot % 8] = (float)c[k];
    }
}

void cloth_fill_hinges( wisp_world* world, wisp_entity surface, const wisp_cloth_def* def )
{
    const wisp_fabric* f = wisp_world_fabric( world, surface );
    float* stiffness = wisp_world_column( world, surface, WISP_HINGE_STIFFNESS, 0 );
    for ( int slot = 0; slot < f->hinge_order.slot_count; ++slot )
    {
        const hinge_shape s =
            f->hinge_order.constraint[slot] >= 0 ? shape_of( f, slot ) : ( hinge_shape ){ .sound = false };
        fill_shape( world, surface, &s, def, slot );
        if ( stiffness != NULL )
        {
            stiffness[slot] = s.sound ? def->bend_stiffness : 0.0f;
        }
    }
}

// ---- bending ----

enum
{
    MAX_STAGES = 512,   // of a substep, a power of two
    BENDING_GRAIN = 32, // slices per block
};

// T_s at the start of the recurrence: short waves are damped to a quarter or less per substep. Up to a third would be stable.
static const double SHORT_WAVES = 4.0;
// Angles change along tangents, which lengthen triangles: by 3 % at a quarter of a radian, threefold at half a turn. So a substep
// moves no vertex farther than this share of the least height around it. All moves are scaled down together, which keeps momenta.
static const float MAX_MOVE = 0.125f;
// Moments of angles change faster than the matrix says where triangles are deformed: the stages take it so many times.
static const double ANGLE_MARGIN = 2.0;

// ---- plates of a world ----

void cloth_release_plate( void* memory, const wisp_allocator* allocator )
{
    cloth_plate* mine = memory;
    wisp_plate_release( mine->plate, allocator );
    allocator->release( allocator->user, mine, sizeof( *mine ) );
}

// @return whether a surface has a plate that serves
static bool has_plate( const cloth_state* state, wisp_entity surface, bool by_angle )
{
    const cloth_plate* mine = wisp_find_object( state->plates, surface );
    return mine != NULL && ( by_angle == false || wisp_plate_get_turns( mine->plate ).begin != NULL );
}

// Another surface of the fabric may have the same plate. @return null: none
static wisp_plate* share_plate( const cloth_state* state, const wisp_fabric* fabric, const float* position,
                                bool by_angle )
{
    const cloth_plate* other;
    wisp_plate* plate = NULL;
    for ( int place = 0; plate == NULL && ( other = wisp_next_object( state->plates, &place ) ) != NULL; )
    {
        plate = wisp_plate_share( other->plate, fabric, position, by_angle );
    }
    return plate;
}

wisp_status cloth_add_plate( wisp_world* world, const cloth_state* state, wisp_entity surface, bool by_angle )
{
    const wisp_fabric* fabric = wisp_world_fabric( world, surface );
    const wisp_allocator* allocator = wisp_world_allocator( world );
    if ( has_plate( state, surface, by_angle ) )
    {
        return WISP_OK;
    }
    cloth_plate* mine = wisp_reserve_object( state->plates, surface )
                            ? allocator->allocate( allocator->user, sizeof( cloth_plate ), 64 )
                            : NULL;
    const float* position = wisp_world_column( world, surface, WISP_PARTICLE_POSITION, 0 );
    wisp_plate* plate = mine != NULL ? share_plate( state, fabric, position, by_angle ) : NULL;
    if ( mine == NULL || ( plate == NULL && wisp_plate_create( fabric, NULL, fabric->slot_count, by_angle, allocator,
                                                               &plate ) != WISP_OK ) )
    {
        wisp_release( allocator, mine, sizeof( cloth_plate ) );
        return wisp_world_fail( world, WISP_NO_MEMORY, "cloth: out of memory for the bending of %d vertices",
                                fabric->vertex_count );
    }
    // the first step computes it again if it is too stiff for the substeps, or has maps
    wisp_plate_update( &plate, fabric, &( wisp_plate_input ){ .position = position, .max_rate = FLT_MAX } );
    *mine = ( cloth_plate ){ .plate = plate };
    wisp_set_object( state->plates, surface, mine );
    return WISP_OK;
}

// ---- a substep ----

typedef struct bending_solve
{
    wisp_plate_args args;
    wisp_plate_angle_args angles; // dihedral; else without rest angles
    wisp_plate_move_args moves;
    const wisp_kernels* kernels;
    bool by_angle;  // else impulses are those of the matrix
    bool is_last;   // stage
    float* largest; // [block] square of a move over the least height
} bending_solve;

// Coefficients of a recurrence of some stages (van der Houwen and Sommeijer 1980).
typedef struct chebyshev
{
    double w0, w1, angle; // T_n( w0 ) = cosh( n angle )
    double reach;         // largest eigenvalue of A for which waves do not grow
} chebyshev;

static chebyshev recurrence_of( int stages )
{
    chebyshev c = { .angle = acosh( SHORT_WAVES ) / stages };
    c.w0 = cosh( c.angle );
    c.w1 = SHORT_WAVES * sinh( c.angle ) / ( stages * sinh( stages * c.angle ) );
    c.reach = ( 1.0 + c.w0 ) / c.w1;
    return c;
}

// The least number that reaches far enough.
static int stages_for( double largest )
{
    int below = 0, stages = 1;
    while ( stages < MAX_STAGES && recurrence_of( stages ).reach < largest )
    {
        below = stages;
        stages *= 2;
    }
    while ( stages - below > 1 )
    {
        const int middle = ( below + stages ) / 2;
        const bool is_enough = recurrence_of( middle ).reach >= largest;
        stages = is_enough ? middle : stages;
        below = is_enough ? below : middle;
    }
    return stages;
}

WISP_KERNEL_RANGE( bending_solve, predict, plate_predict, moves, 1 )

WISP_KERNEL_RANGE( bending_solve, measure_angles, plate_measure_angles, angles, 8 )

WISP_KERNEL_RANGE( bending_solve, couple_angles, plate_couple_angles, angles, 8 )

static void add_moments( const void* context, int begin, int end )
{
    const bending_solve* b = context;
    b->kernels->plate_add_moments( &b->angles, begin, end );
}

static void measure_last( const bending_solve* b, int begin, int end )
{
    if ( b->is_last && b->by_angle )
    {
        b->largest[begin / BENDING_GRAIN] = b->kernels->plate_largest_move( &b->moves, begin, end );
    }
}

static void begin_stages( void* context, int begin, int end, int worker )
{
    (void)worker;
    const bending_solve* b = context;
    if ( b->by_angle == false )
    {
        b->kernels->plate_impulse( &b->args, begin, end );
    }
    b->kernels->plate_begin( &b->args, begin, end );
    measure_last( b, begin, end );
}

static void run_stage( void* context, int begin, int end, int worker )
{
    (void)worker;
    const bending_solve* b = context;
    b->kernels->plate_stage( &b->args, begin, end );
    measure_last( b, begin, end );
}

WISP_KERNEL_RANGE( bending_solve, accelerate, plate_accelerate, moves, 1 )

static void for_slices( const wisp_parallel* parallel, bending_solve* b, wisp_range_fn* run )
{
    wisp_parallel_for( parallel, b->args.rows.slice_count, BENDING_GRAIN, run, b );
}

static void run_stages( const wisp_parallel* parallel, bending_solve* b, int stages )
{
    const chebyshev c = recurrence_of( stages );
    b->args.gain = (float)( c.w1 / c.w0 );
    b->moves.moved = b->args.newer;
    b->is_last = stages == 1;
    for_slices( parallel, b, begin_stages );
    for ( int n = 2; n <= stages; ++n )
    {
        const double now = cosh( n * c.angle );
        b->args.momentum = (float)( cosh( ( n - 2 ) * c.angle ) / now );
        b->args.gain = (float)( 2.0 * c.w1 * cosh( ( n - 1 ) * c.angle ) / now );
        float* y = b->args.older;
        b->moves.moved = y;
        b->is_last = n == stages;
        for_slices( parallel, b, run_stage );
        b->args.older = b->args.newer;
        b->args.newer = y;
    }
}

static float scale_of_moves( const bending_solve* b )
{
    float largest = 0.0f;
    for ( int block = 0; BENDING_GRAIN * block < b->args.rows.slice_count; ++block )
    {
        largest = fmaxf( largest, b->largest[block] );
    }
    return largest > MAX_MOVE * MAX_MOVE ? MAX_MOVE / sqrtf( largest ) : 1.0f;
}

// Impulses of angles, for which the rows of the matrix stand in the stages: they are an upper bound while triangles keep half of
// their heights.
static void compute_angle_impulse( const wisp_parallel* parallel, const wisp_fabric* fabric, bending_solve* b )
{
    wisp_parallel_for( parallel, fabric->hinge_order.slot_count / 8, BENDING_GRAIN, measure_angles, b );
    wisp_parallel_for( parallel, fabric->hinge_order.slot_count / 8, BENDING_GRAIN, couple_angles, b );
    wisp_run_schedule( parallel, b->angles.turns.triangles, add_moments, b );
}

// Columns and scratch memory of a surface. @return false without memory
static bool find_arrays( wisp_frame* frame, const wisp_span* span, bending_solve* b )
{
    const wisp_fabric* fabric = wisp_frame_fabric( frame, span->entity );
    const size_t numbers = 4 * (size_t)fabric->slot_count, hinges = (size_t)fabric->hinge_order.slot_count;
    const size_t blocks = numbers / 32 / BENDING_GRAIN + 1;
    // angles and their moments are done with when the stages begin
    const size_t shared = 2 * numbers > 2 * hinges + 1 ? 2 * numbers : 2 * hinges + 1;
    float* scratch = wisp_parallel_scratch( wisp_frame_parallel( frame, span ), span->worker,
                                            ( 2 * numbers + shared + blocks ) * sizeof( float ) );
    if ( scratch == NULL )
    {
        wisp_frame_fail( frame, WISP_NO_MEMORY, "out of memory for the bending of %zu particles", numbers / 4 );
        return false;
    }
    const wisp_vec3* gravity = wisp_frame_column( frame, span->entity, WISP_PARTICLE_GRAVITY, 0 );
    const float* target = wisp_frame_column( frame, span->entity, WISP_PARTICLE_TARGET, 0 );
    const float* position = wisp_frame_column( frame, span->entity, WISP_PARTICLE_POSITION, 0 );
    b->kernels = wisp_frame_kernels( frame );
    b->args.position = scratch;
    b->args.impulse = scratch + numbers;
    b->args.newer = scratch + 2 * numbers;
    b->args.older = scratch + 3 * numbers;
    b->moves = ( wisp_plate_move_args ){
        .position = position,
        .target = target != NULL ? target : position,
        .predicted = scratch,
        .impulse = b->args.impulse,
        .velocity = wisp_frame_column( frame, span->entity, WISP_PARTICLE_VELOCITY, 0 ),
        .gravity = gravity != NULL ? *gravity : ( wisp_vec3 ){ 0.0f, 0.0f, 0.0f },
        .dt = wisp_frame_dt( frame, span->entity ),
        .to_target = wisp_frame_progress_left( frame, span->entity, span->substep ),
        .scale = 1.0f,
    };
    b->angles = ( wisp_plate_angle_args ){
        .slot_x4 = fabric->hinge_slot_x4,
        .rest = wisp_frame_column( frame, span->entity, WISP_HINGE_REST, 0 ),
        .position = scratch,
        .angle = scratch + 2 * numbers,
        .moment = scratch + 2 * numbers + hinges,
        .impulse = b->args.impulse,
    };
    b->by_angle = b->angles.rest != NULL;
    b->angles.moment[hinges] = 0.0f;
    b->largest = scratch + 2 * numbers + shared;
    return true;
}

// Coefficients of this step, which change only between steps. @return the largest eigenvalue of A; below 0 without memory
static double update_plate( wisp_frame* frame, const wisp_span* span, cloth_plate* mine, bending_solve* b )
{
    const wisp_fabric* fabric = wisp_frame_fabric( frame, span->entity );
    const double reach = recurrence_of( MAX_STAGES ).reach, margin = b->by_angle ? ANGLE_MARGIN : 1.0;
    if ( span->substep == 0 )
    {
        const wisp_plate_input input = {
            .position = b->moves.position,
            .factors = wisp_frame_column( frame, span->entity, WISP_MAP_BEND_RIGIDITY, 0 ),
            .has_mass_map = wisp_frame_has( frame, span->entity, WISP_MAP_AREA_DENSITY ),
            // where a few triangles alone are too stiff, only they are lowered; a vertex lies in several of their patches
            .max_rate = (float)( reach / ( 4.0 * margin * (double)b->args.rate ) ),
        };
        const int lowered = wisp_plate_update( &mine->plate, fabric, &input );
        if ( lowered < 0 )
        {
            wisp_frame_fail( frame, WISP_NO_MEMORY, "out of memory for the bending of %d vertices",
                             fabric->vertex_count );
            return -1.0;
        }
        mine->lowered = lowered;
    }
    const double largest = margin * (double)b->args.rate * (double)wisp_plate_max_rate( mine->plate );
    b->args.rate *= largest > reach ? (float)( reach / largest ) : 1.0f;
    if ( mine->lowered > 0 || largest > reach )
    {
        wisp_frame_count( frame, WISP_COUNT_STIFFNESS_CLAMPED, 1 );
    }
    return largest;
}

void cloth_bend( wisp_frame* frame, const wisp_span* span, void* user )
{
    const cloth_state* state = user;
    cloth_plate* mine = wisp_find_object( state->plates, span->entity );
    const wisp_parallel* parallel = wisp_frame_parallel( frame, span );
    bending_solve b = { .is_last = false };
    if ( find_arrays( frame, span, &b ) == false )
    {
        return;
    }
    b.args.rate = *(float*)wisp_frame_column( frame, span->entity, state->bending, 0 ) * b.moves.dt * b.moves.dt;
    b.args.rows = wisp_plate_get_rows( mine->plate );
    b.angles.turns = wisp_plate_get_turns( mine->plate );
    const double largest = update_plate( frame, span, mine, &b );
    if ( largest < 0.0 )
    {
        return;
    }
    for_slices( parallel, &b, predict );
    if ( b.by_angle )
    {
        b.moves.least_height = b.angles.turns.least_height;
        b.angles.rate = b.args.rate;
        b.args.rate *= (float)ANGLE_MARGIN;
        compute_angle_impulse( parallel, wisp_frame_fabric( frame, span->entity ), &b );
    }
    run_stages( parallel, &b, stages_for( largest ) );
    b.moves.scale = b.by_angle ? scale_of_moves( &b ) : 1.0f;
    for_slices( parallel, &b, accelerate );
}
