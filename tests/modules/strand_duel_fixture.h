/// Moving strands in the engine and in the oracle: the same strands, velocities and head in both, and a substep of
/// the oracle in the order of the module's passes.
#pragma once

#include "strands_fixture.h"

#include "oracle/strand_oracle.h"

enum
{
    SHAPES = 3,
    STRANDS = 15,
    LONGEST = 20,
    SUBSTEPS = 8,
};

static const int COUNTS[STRANDS] = { 1, 1, 1, 2, 2, 2, 3, 3, 3, 9, 9, 9, 20, 20, 20 };
static const float SEGMENT = 0.005f; // m
// The kernel ends Newton after the pass in which no squared length is off by more than this fraction.
static const double EXACT = 4e-5;
// The module's limits of dt^2 EI / (m l^3), for any rod, and for a curled one times the fourth power of its turn.
static const double MAX_STIFFNESS = 6e4, MAX_CURLED = 0.08;

typedef struct duel
{
    const char* name;
    wisp_strand_stretch stretch;
    wisp_strand_bend bend;
    wisp_strand_rest rest;
    wisp_solver solver;
    float compliance, bend_compliance; // m/N
    float rigidity;                    // N m^2; 0: the default, that of a hair
    float damping, drag, bend_damping;
    bool carried, hinged, pinned, bdf2;
    int iterations; // 0: one
    float dt;       // s, of a substep
    double ease;    // times the tolerances; 0: once
    float edgewise; // EI' over EI of an elliptic section; 0: circular
    wisp_strand_tip tips;
} duel;

static const float SLOW = 1.0f / 480.0f, FAST = 1.0f / 1920.0f;

// ---- the same strands in both ----

typedef struct match
{
    const duel* rules;
    hosted s;
    wisp_entity e;
    wisp_strand_dynamics_def def;
    int substeps;
    double dt;
    double3 gravity;         // of the oracle
    wisp_transform from, to; // of the head, in this step
    double3 rest[STRANDS][LONGEST];
    double balanced[STRANDS]; // fraction of the weight that the rest shape carries
    double rest_tension[STRANDS][LONGEST];
    strand_oracle_quaternion tip[STRANDS]; // frames of tips at rest
    strand_oracle strand[STRANDS];
    strand_oracle_past past[STRANDS];
    double step[STRANDS];  // s, of the implicit step
    bool is_lost[STRANDS]; // the history, for the next substep
} match;

static inline float random_at( int n, int what )
{
    const double unit = wisp_random_unit( wisp_random_make_key( 7, 0, 0 ), (uint32_t)n, (uint32_t)what, 0 );
    return (float)( 2.0 * unit - 1.0 );
}

static inline wisp_vec3 crooked_step( int strand, int i )
{
    const int n = 32 * strand + i;
    const float length = SEGMENT * ( 1.0f + 0.2f * random_at( n, 3 ) );
    const wisp_vec3 d = { 0.28f * random_at( n, 0 ), -1.0f + 0.28f * random_at( n, 1 ), 0.28f * random_at( n, 2 ) };
    const float scale = length / sqrtf( d.x * d.x + d.y * d.y + d.z * d.z );
    return ( wisp_vec3 ){ scale * d.x, scale * d.y, scale * d.z };
}

// Crooked, curled and straight in turn; each kind hangs, sticks out or rises.
static inline wisp_vec3 shape_at( int strand, int i, int count, float length )
{
    (void)count;
    (void)length;
    const float t = SEGMENT * (float)i, angle = 0.6f * (float)i + (float)strand;
    wisp_vec3 p = { 0.006f * (float)( strand - STRANDS / 2 ), 0.02f, 0.01f * (float)( strand % 4 ) };
    if ( strand % SHAPES == 0 )
    {
        for ( int k = 0; k < i; ++k )
        {
            const wisp_vec3 e = crooked_step( strand, k );
            p = ( wisp_vec3 ){ p.x + e.x, p.y + e.y, p.z + e.z };
        }
    }
    else if ( strand % SHAPES == 1 )
    {
        p.x += 0.005f * ( cosf( angle ) - cosf( (float)strand ) );
        p.y += 0.005f * ( sinf( angle ) - sinf( (float)strand ) );
        p.z += 0.8f * t;
    }
    else
    {
        p.x += 0.6f * t;
        p.y -= 0.48f * t;
        p.z += 0.64f * t;
    }
    return p;
}

static inline wisp_strand_dynamics_def def_of( const duel* rules )
{
    // in the crooked strand of nine vertices and in the curled one of twenty
    static const int32_t PINS[] = { 18 + 5, 18 + 27 + 20 + 9 };
    wisp_strand_dynamics_def def = undamped_hair();
    def.stretch = rules->stretch;
    def.integrator = rules->bdf2 ? WISP_INTEGRATOR_BDF2 : WISP_INTEGRATOR_EULER;
    def.bending = rules->bend;
    def.rest = rules->rest;
    def.solver = rules->solver;
    def.stretch_compliance = rules->compliance;
    def.bend_compliance = rules->bend_compliance;
    def.bend_rigidity = rules->rigidity > 0.0f ? rules->rigidity : def.bend_rigidity;
    def.twist_rigidity = 0.75f * def.bend_rigidity;
    def.edgewise_rigidity = rules->edgewise * def.bend_rigidity;
    def.bend_damping = rules->bend_damping;
    def.clamped = rules->hinged == false;
    def.damping = rules->damping;
    def.drag_coefficient = rules->drag;
    def.wind = ( wisp_vec3 ){ 1.0f, 0.5f, -2.0f };
    def.pins = PINS;
    def.pin_count = rules->pinned ? WISP_COUNT( PINS ) : 0;
    return def;
}

// Straight strands that are held at both ends are taut: single precision does not say where they go.
static inline wisp_strand_tip hold_of( const duel* rules, int n )
{
    return n % SHAPES == SHAPES - 1 && COUNTS[n] > 2 ? rules->tips & WISP_STRAND_TIP_GUIDED : rules->tips;
}

static inline bool is_curled( const duel* rules )
{
    return rules->bend == WISP_STRAND_BEND_ROD && rules->rest != WISP_STRAND_REST_STRAIGHT;
}

// |t_i - t_{i-1}|; the ends have none.
static inline double turn_of( const strand_oracle* strand, int i )
{
    if ( i < 1 || i + 1 >= strand->count )
    {
        return 0.0;
    }
    const double3 a = double3_sub( strand->position[i], strand->position[i - 1] );
    const double3 b = double3_sub( strand->position[i + 1], strand->position[i] );
    return double3_distance( double3_scale( 1.0 / strand->length[i - 1], a ),
                             double3_scale( 1.0 / strand->length[i], b ) );
}

static inline double stiffest( const match* m )
{
    return fmax( (double)m->def.bend_rigidity, (double)m->def.edgewise_rigidity );
}

// EI of vertex i relative to the module's limit: above 1 the module lowers it. The mass is the mean of those
// neighbouring vertices that move.
static inline double over_the_cap( const match* m, const strand_oracle* strand, int n, int i )
{
    const bool is_bounded = is_curled( m->rules ) || hold_of( m->rules, n ) != WISP_STRAND_TIP_FREE;
    double mass = 0.0, turn = 0.0;
    int free_count = 0;
    for ( int k = i > 0 ? i - 1 : 0; k <= i + 1 && k < strand->count; ++k )
    {
        mass += strand->weight[k] > 0.0 ? strand->mass[k] : 0.0;
        free_count += strand->weight[k] > 0.0 ? 1 : 0;
        turn = fmax( turn, is_bounded ? turn_of( strand, k ) : 0.0 );
    }
    const double own = i + 1 < strand->count ? strand->length[i] : strand->length[i - 1];
    const double l = i > 0 ? fmin( strand->length[i - 1], own ) : own;
    const double most = fmin( MAX_STIFFNESS, MAX_CURLED / fmax( pow( turn, 4.0 ), 1e-12 ) );
    const double ratio =
        m->dt * ( m->dt + (double)m->def.bend_damping ) * stiffest( m ) / ( mass / free_count * l * l * l );
    return ratio / most;
}

static inline void stiffen( const match* m, strand_oracle* strand, int n )
{
    strand_oracle_stiffen( strand, stiffest( m ), (double)m->def.twist_rigidity, m->def.clamped, 0.0 );
    for ( int i = 0; i + 1 < strand->count + ( strand->guided ? 1 : 0 ); ++i )
    {
        const double over = fmax( over_the_cap( m, strand, n, i ), 1.0 );
        // the balance under a lowered stiffness is the module's own choice and is not compared here
        assert_true( over == 1.0 || m->rules->rest != WISP_STRAND_REST_SAG_FREE );
        strand->stiffness[i] /= over;
        strand->twist_stiffness[i] /= over;
    }
}

// A straight rod starts with at most the weight beyond the segment, between pins with four times the whole weight.
static inline void bound_tension( const match* m, strand_oracle* strand, bool is_tip_held )
{
    double whole = 0.0, behind = 0.0;
    bool held = false;
    for ( int i = 1; i < strand->count; ++i )
    {
        whole += strand->weight[i] > 0.0 ? strand->mass[i] : 0.0;
        held = held || strand->weight[i] <= 0.0;
    }
    for ( int i = strand->count - 1; i > 0; --i )
    {
        behind += strand->mass[i];
        strand->max_tension[i - 1] = double3_length( m->gravity ) * ( held ? 4.0 * whole : behind );
    }
    // one whose tip is held with what its bending holds too, and no more than a substep can apply without a solve
    for ( int s = 0; s + 1 < strand->count && is_tip_held; ++s )
    {
        const double* w = strand->weight;
        const double a = w[s] > 0.0 ? strand->mass[s] : INFINITY, b = w[s + 1] > 0.0 ? strand->mass[s + 1] : INFINITY;
        const double mass = fmin( a, b ) < INFINITY ? fmin( a, b ) : 0.0, l = strand->length[s];
        const double rigidity = 0.5 * strand->stiffness[s] * ( ( s > 0 ? strand->length[s - 1] : 0.0 ) + l );
        strand->max_tension[s] =
            fmin( 4.0 * double3_length( m->gravity ) * whole, 0.125 * mass * l / ( m->dt * m->dt ) ) +
            fmin( rigidity / ( l * l ), sqrt( 0.25 * MAX_CURLED * rigidity * mass / l ) / m->dt );
    }
}

static inline void shape_oracle( match* m, int n, int first_vertex )
{
    strand_oracle* strand = m->strand + n;
    for ( int i = 0; i < COUNTS[n]; ++i )
    {
        m->rest[n][i] = double3_widen( shape_at( n, i, COUNTS[n], 0.0f ) );
    }
    assert_true( strand_oracle_shape( strand, m->rest[n], COUNTS[n] ) );
    strand_oracle_weigh( strand, (double)m->def.line_density, true );
    for ( int k = 0; k < m->def.pin_count; ++k )
    {
        const int i = m->def.pins[k] - first_vertex;
        if ( i > 0 && i < strand->count )
        {
            strand_oracle_pin( strand, i );
        }
    }
    const wisp_strand_tip hold = hold_of( m->rules, n );
    strand->held_diagonal = m->rules->tips != WISP_STRAND_TIP_FREE ? 1.0 + 1e-5 : 1.0;
    if ( hold != WISP_STRAND_TIP_FREE && strand->count > 1 )
    {
        strand->guided = ( hold & WISP_STRAND_TIP_GUIDED ) != 0;
        if ( ( hold & WISP_STRAND_TIP_PINNED ) != 0 )
        {
            strand_oracle_pin( strand, strand->count - 1 );
        }
    }
    strand->flatness = m->rules->edgewise > 0.0f ? sqrt( 1.0 - 1.0 / (double)m->rules->edgewise ) : 0.0;
    stiffen( m, strand, n );
    if ( m->def.rest == WISP_STRAND_REST_STRAIGHT )
    {
        bound_tension( m, strand, hold != WISP_STRAND_TIP_FREE );
        strand_oracle_rest_straight( strand );
    }
    else if ( m->def.rest == WISP_STRAND_REST_SHAPE )
    {
        strand_oracle_rest_shape( strand );
    }
    else
    {
        m->balanced[n] = strand_oracle_balance_stably( strand, m->gravity, 1.57 );
    }
    memcpy( m->rest_tension[n], strand->tension, sizeof( m->rest_tension[n] ) );
    m->tip[n] = strand->frame[strand->count - 1];
}

// Give every free vertex the same velocity, of up to `speed`, in both.
static inline void kick( match* m, float speed )
{
    const wisp_strand_topology* t = wisp_world_strands( m->s.world, m->e );
    float* velocity = wisp_world_column( m->s.world, m->e, WISP_STRAND_VELOCITY, 0 );
    for ( int lane = 0; lane < WISP_LANES; ++lane )
    {
        for ( int i = 1; i < t->lane_count[lane]; ++i )
        {
            strand_oracle* strand = m->strand + t->lane_strand[lane];
            const int n = 32 * t->lane_strand[lane] + i;
            const float fraction = strand->weight[i] > 0.0 ? speed : 0.0f;
            const wisp_vec3 v = { fraction * random_at( n, 4 ), fraction * random_at( n, 5 ),
                                  fraction * random_at( n, 6 ) };
            float* row = velocity + (size_t)i * 3 * WISP_LANES + lane;
            row[0] = v.x;
            row[WISP_LANES] = v.y;
            row[2 * WISP_LANES] = v.z;
            strand->velocity[i] = double3_widen( v );
        }
    }
}

static inline match* open_match( const duel* rules, int substeps, float speed )
{
    match* m = checked_calloc( 1, sizeof( match ) );
    const wisp_transform origin = { { 0.0f, 0.0f, 0.0f, 1.0f }, { 0.0f, 0.0f, 0.0f } };
    m->rules = rules;
    m->def = def_of( rules );
    m->substeps = substeps;
    m->dt = (double)rules->dt;
    m->gravity = double3_widen( m->def.gravity );
    m->from = m->to = origin;
    open_strands( &m->s, substeps, rules->iterations > 0 ? rules->iterations : 1, 1 );
    m->e = add_strands( m->s.world, COUNTS, STRANDS, shape_at, 0.0f );
    if ( wisp_set_strand_dynamics( m->s.world, m->e, &m->def ) != WISP_OK )
    {
        fail_msg( "no dynamics: %s", wisp_world_message( m->s.world ) );
    }
    for ( int n = 0; n < STRANDS && rules->tips != WISP_STRAND_TIP_FREE; ++n )
    {
        const wisp_status status = wisp_hold_strand_tip( m->s.world, m->e, n, hold_of( rules, n ) );
        assert_int_equal( status, COUNTS[n] > 1 ? WISP_OK : WISP_BAD_INPUT );
    }
    assert_int_equal( wisp_request( m->s.world, m->e, WISP_STRAND_POINTS ), WISP_OK );
    assert_int_equal( wisp_world_strands( m->s.world, m->e )->group_count, 1 );
    for ( int n = 0, first = 0; n < STRANDS; first += COUNTS[n], ++n )
    {
        shape_oracle( m, n, first );
    }
    kick( m, speed );
    return m;
}

static inline void close_match( match* m )
{
    // all that is compared here is solved for
    assert_int_equal( wisp_world_counter( m->s.world, WISP_COUNT_STRAND_RESET ), 0 );
    assert_int_equal( wisp_world_counter( m->s.world, WISP_COUNT_HALTED ), 0 );
    close_world( &m->s );
    free( m );
}

// ---- the head ----

typedef struct pose
{
    strand_oracle_quaternion rotation;
    double3 place;
} pose;

// In a straight line, and along the chord from one quaternion to the other.
static inline pose pose_at( const match* m, double fraction )
{
    const wisp_quat a = m->from.rotation, b = m->to.rotation;
    const double s = 1.0 - fraction;
    strand_oracle_quaternion q = { s * (double)a.x + fraction * (double)b.x, s * (double)a.y + fraction * (double)b.y,
                                   s * (double)a.z + fraction * (double)b.z,
                                   s * (double)a.w + fraction * (double)b.w };
    const double length = sqrt( q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w );
    q = ( strand_oracle_quaternion ){ q.x / length, q.y / length, q.z / length, q.w / length };
    return ( pose ){ q, double3_add( double3_scale( s, double3_widen( m->from.translation ) ),
                                     double3_scale( fraction, double3_widen( m->to.translation ) ) ) };
}

static inline double3 carry( pose p, double3 at )
{
    return double3_add( p.place, strand_oracle_turned( p.rotation, at ) );
}

static inline double3 angular_velocity( pose a, pose b, double dt )
{
    const strand_oracle_quaternion back = { -a.rotation.x, -a.rotation.y, -a.rotation.z, a.rotation.w };
    const strand_oracle_quaternion turn = strand_oracle_product( b.rotation, back );
    const double3 axis = { turn.x, turn.y, turn.z };
    const double half_sine = double3_length( axis );
    return half_sine > 0.0 ? double3_scale( 2.0 * atan2( half_sine, turn.w ) / ( half_sine * dt ), axis ) : axis;
}

// After this number of substeps: it turns about an axis of its own and moves at 0.6 m/s.
static inline wisp_transform head_behind( const duel* rules, int substeps )
{
    const float t = rules->carried ? rules->dt * (float)substeps : 0.0f;
    return head_at( 8.0f * t, ( wisp_vec3 ){ 0.6f, 0.0f, 0.8f }, ( wisp_vec3 ){ 0.4f * t, -0.2f * t, 0.4f * t } );
}

// ---- a substep of the oracle, in the order of the module's passes ----

static inline void hold_pins( match* m, int n, pose to )
{
    strand_oracle* strand = m->strand + n;
    for ( int i = 1; i < strand->count; ++i )
    {
        if ( strand->weight[i] <= 0.0 )
        {
            const double3 place = carry( to, m->rest[n][i] );
            strand->velocity[i] = double3_scale( 1.0 / m->dt, double3_sub( place, strand->position[i] ) );
            strand->position[i] = place;
        }
    }
}

// Look back if there is something to look back on. @return whether it is a substep of second order
static inline bool begin_substep( match* m, int n, double3* start )
{
    strand_oracle* strand = m->strand + n;
    const bool is_second = m->rules->bdf2 && m->past[n].exists && m->is_lost[n] == false;
    m->step[n] = is_second ? 2.0 / 3.0 * m->dt : m->dt;
    m->is_lost[n] = false;
    if ( is_second )
    {
        strand_oracle_extrapolate( strand, m->past + n, start );
        return true;
    }
    memcpy( m->past[n].position, strand->position, sizeof( strand->position ) );
    memcpy( m->past[n].velocity, strand->velocity, sizeof( strand->velocity ) );
    m->past[n].exists = true;
    return false;
}

static inline void force_and_predict( match* m, int n, pose from, pose to )
{
    const wisp_strand_dynamics_def* def = &m->def;
    strand_oracle* strand = m->strand + n;
    const double3 root = carry( to, m->rest[n][0] );
    double3 start[MAX_STRAND_ORACLE];
    hold_pins( m, n, to );
    const bool is_second = begin_substep( m, n, start );
    const double step = m->step[n];
    if ( def->damping > 0.0f )
    {
        const double3 linear = double3_scale( 1.0 / m->dt, double3_sub( to.place, from.place ) );
        strand_oracle_damp( strand, 1.0 / ( 1.0 + (double)def->damping * step ), linear,
                            angular_velocity( from, to, m->dt ), from.place );
    }
    if ( def->drag_coefficient > 0.0f )
    {
        const double drag = 0.5 * (double)def->air_density * (double)def->drag_coefficient * (double)def->diameter;
        strand_oracle_air( strand, double3_widen( def->wind ), drag, step );
    }
    if ( is_second )
    {
        strand_oracle_predict_bdf2( strand, start, &root, m->gravity, m->dt );
    }
    else
    {
        strand_oracle_predict( strand, &root, m->gravity, m->dt );
    }
    if ( def->bending == WISP_STRAND_BEND_ROD )
    {
        if ( is_curled( m->rules ) )
        {
            memcpy( strand->tension, m->rest_tension[n], sizeof( m->rest_tension[n] ) );
        }
        strand->turn = to.rotation;
        strand->frame[strand->count - 1] =
            strand->guided ? strand_oracle_product( to.rotation, m->tip[n] ) : strand->frame[strand->count - 1];
        strand_oracle_rod_factor( strand, (double)def->bend_damping, step );
        strand_oracle_rod( strand, (double)def->bend_damping, step, &m->gravity );
    }
}

static inline strand_oracle_link_rule rule_of( const match* m, int n, float stiffness, float compliance )
{
    const bool compliant = m->def.solver == WISP_SOLVER_XPBD;
    return ( strand_oracle_link_rule ){ (double)stiffness, (double)compliance,
                                        compliant ? 1.0 / ( m->step[n] * m->step[n] ) : 0.0 };
}

static inline void sweep( match* m, int n, int iteration )
{
    strand_oracle* strand = m->strand + n;
    double two[LONGEST];
    for ( int i = 0; i + 2 < strand->count; ++i )
    {
        two[i] = double3_distance( m->rest[n][i], m->rest[n][i + 2] );
    }
    if ( iteration == 0 )
    {
        memset( strand->stretch_lambda, 0, sizeof( strand->stretch_lambda ) );
        memset( strand->bend_lambda, 0, sizeof( strand->bend_lambda ) );
    }
    if ( m->def.bending == WISP_STRAND_BEND_LINKS )
    {
        strand_oracle_link( strand, two, strand->bend_lambda, 2,
                            rule_of( m, n, m->def.bend_stiffness, m->def.bend_compliance ) );
    }
    if ( m->def.stretch == WISP_STRAND_STRETCH_LINKS )
    {
        strand_oracle_link( strand, strand->length, strand->stretch_lambda, 1,
                            rule_of( m, n, m->def.stretch_stiffness, m->def.stretch_compliance ) );
    }
}

static inline bool is_exact( const strand_oracle* strand )
{
    bool exact = true;
    for ( int s = 0; s + 1 < strand->count; ++s )
    {
        const double3 e = double3_sub( strand->position[s + 1], strand->position[s] );
        const double square = strand->length[s] * strand->length[s];
        exact = exact && fabs( double3_dot( e, e ) - square ) <= EXACT * square;
    }
    return exact;
}

// A strand whose prediction, without the acceleration that a rod has not balanced, is this far from its lengths goes on
// by Euler, from the start to where it is now.
static inline void break_unpredicted( match* m, int n )
{
    const double UNPREDICTED = 0.5;
    strand_oracle* strand = m->strand + n;
    const double back = m->def.bending == WISP_STRAND_BEND_ROD ? 0.0 : m->step[n] * m->step[n];
    bool is_far = false;
    for ( int s = 0; s + 1 < strand->count; ++s )
    {
        const double ends = ( strand->weight[s + 1] > 0.0 ? 1.0 : 0.0 ) - ( strand->weight[s] > 0.0 ? 1.0 : 0.0 );
        const double3 e = double3_add_scaled( double3_sub( strand->position[s + 1], strand->position[s] ),
                                              -back * ends, m->gravity );
        const double square = strand->length[s] * strand->length[s];
        is_far = is_far || fabs( double3_dot( e, e ) - square ) > UNPREDICTED * square;
    }
    m->is_lost[n] = m->is_lost[n] || is_far;
    for ( int i = 0; i < strand->count && is_far && m->step[n] < m->dt; ++i )
    {
        if ( strand->weight[i] > 0.0 )
        {
            strand->previous[i] = m->past[n].position[i];
            strand->velocity[i] =
                double3_scale( 1.0 / m->dt, double3_sub( strand->position[i], strand->previous[i] ) );
        }
    }
    m->step[n] = is_far ? m->dt : m->step[n];
}

// Lanes of a group iterate together until all are exact.
static inline void stretch_group( match* m, int iteration )
{
    bool exact = false;
    for ( int n = 0; n < STRANDS && m->rules->bdf2; ++n )
    {
        break_unpredicted( m, n );
    }
    for ( int pass = 0; pass < m->def.stretch_passes && exact == false; ++pass )
    {
        const bool keeps = m->def.bending == WISP_STRAND_BEND_ROD || iteration > 0 || pass > 0;
        exact = true;
        for ( int n = 0; n < STRANDS; ++n )
        {
            (void)strand_oracle_stretch( m->strand + n, STRAND_ORACLE_SQUARE, 1, INFINITY, keeps, m->step[n] );
            exact = exact && is_exact( m->strand + n );
        }
    }
}

static inline void oracle_substep( match* m, int substep )
{
    const pose from = pose_at( m, (double)substep / m->substeps ), to = pose_at( m, ( substep + 1.0 ) / m->substeps );
    for ( int n = 0; n < STRANDS; ++n )
    {
        force_and_predict( m, n, from, to );
    }
    for ( int k = 0; k < ( m->rules->iterations > 0 ? m->rules->iterations : 1 ); ++k )
    {
        for ( int n = 0; n < STRANDS; ++n )
        {
            sweep( m, n, k );
        }
        if ( m->def.stretch == WISP_STRAND_STRETCH_DIRECT )
        {
            stretch_group( m, k );
        }
    }
    for ( int n = 0; n < STRANDS; ++n )
    {
        strand_oracle_velocity( m->strand + n, m->step[n] );
    }
}

// ---- comparing ----

// One step of both, number `step` from 0.
static inline void step_both( match* m, int step )
{
    m->from = m->to;
    m->to = head_behind( m->rules, ( step + 1 ) * m->substeps );
    assert_int_equal( wisp_move_strand_head( m->s.world, m->e, m->to ), WISP_OK );
    strand_steps( m->s.world, 1, m->rules->dt * (float)m->substeps );
    for ( int k = 0; k < m->substeps; ++k )
    {
        oracle_substep( m, k );
    }
}

// The largest distance between a vertex of one and the same vertex of the other, m; NaN if a vertex is NaN.
static inline double apart( match* m, int* strand, int* vertex )
{
    const wisp_vec3* points = strand_points( m->s.world, m->e );
    double most = 0.0;
    for ( int n = 0, first = 0; n < STRANDS; first += COUNTS[n], ++n )
    {
        for ( int i = 0; i < COUNTS[n]; ++i )
        {
            const double distance = double3_distance( double3_widen( points[first + i] ), m->strand[n].position[i] );
            if ( isnan( most ) == false && !( distance <= most ) )
            {
                most = distance;
                *strand = n;
                *vertex = i;
            }
        }
    }
    return most;
}
