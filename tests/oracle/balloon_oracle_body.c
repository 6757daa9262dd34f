// A balloon of the oracle, step by step.
#include "balloon_oracle.h"

#include "oracle_check.h"

#include <stdlib.h>
#include <string.h>

// ---- definition ----

// What a balloon of the oracle is made of: options, creation.

balloon_oracle_options balloon_oracle_default_options( void )
{
    balloon_oracle_options options = {
        .dt = 1.0 / 60.0,
        .substeps = 10,
        .iterations = 2,
        .volume = BALLOON_ORACLE_VOLUME_XPBD,
        .pressure = BALLOON_ORACLE_PRESSURE_VIRIAL,
        .drag = BALLOON_ORACLE_DRAG_MAX,
        .spin = BALLOON_ORACLE_SPIN_KICK,
        .use_gravity = true,
        .use_buoyancy = true,
        .use_drag = true,
        .use_jet = true,
        .limit_drag = true,
        .gravity = { 0.0, -9.8, 0.0 },
        .atmosphere = 101325.0,
        .temperature = 293.15,
        .gas_molar_mass = BALLOON_ORACLE_HELIUM,
        .air_molar_mass = BALLOON_ORACLE_AIR,
        .drag_coefficient = 0.5,
        .outlet_area = 1e-4,
        .structural_k = 0.9,
        .bend_k = 0.1,
        .volume_k = 1.0,
        .structural_stiffness = 2000.0,
        .bend_stiffness = 20.0,
        .close_at = 1e-4,
        .open_at = 5e-4,
        .min_volume = 1.0,
    };
    return options;
}

// Creation.

static bool allocate( const balloon_oracle_def* def, balloon_oracle* b )
{
    size_t n = (size_t)def->vertex_count;
    double3** vectors[] = { &b->x, &b->p, &b->predicted, &b->v, &b->force, &b->normal, &b->gradient };
    double** numbers[] = { &b->mass, &b->w, &b->area };
    bool complete = true;
    for ( int k = 0; k < WISP_COUNT( vectors ); ++k )
    {
        *vectors[k] = calloc( n, sizeof( double3 ) );
        complete = complete && *vectors[k] != NULL;
    }
    for ( int k = 0; k < WISP_COUNT( numbers ); ++k )
    {
        *numbers[k] = calloc( n, sizeof( double ) );
        complete = complete && *numbers[k] != NULL;
    }
    b->triangles = calloc( 3 * (size_t)def->triangle_count, sizeof( int ) );
    b->outlet = calloc( (size_t)def->outlet_count + 1, sizeof( int ) );
    b->structural = calloc( (size_t)def->structural_count + 1, sizeof( balloon_oracle_link ) );
    b->bend = calloc( (size_t)def->bend_count + 1, sizeof( balloon_oracle_link ) );
    return complete && b->triangles != NULL && b->outlet != NULL && b->structural != NULL && b->bend != NULL;
}

void balloon_oracle_destroy( balloon_oracle* b )
{
    void* blocks[] = { b->x,    b->p, b->predicted, b->v,         b->force,  b->normal,     b->gradient,
                       b->mass, b->w, b->area,      b->triangles, b->outlet, b->structural, b->bend };
    for ( int k = 0; k < WISP_COUNT( blocks ); ++k )
    {
        free( blocks[k] );
    }
    balloon_oracle_destroy_caps( &b->caps );
    *b = ( balloon_oracle ){ 0 };
}

static void copy_links( const double3* x, const int* pairs, int count, balloon_oracle_link* links )
{
    for ( int e = 0; e < count; ++e )
    {
        int a = pairs[2 * e], c = pairs[2 * e + 1];
        links[e] = ( balloon_oracle_link ){ a, c, double3_distance( x[a], x[c] ), 0.0 };
    }
}

static void copy_def( const balloon_oracle_def* def, balloon_oracle* b )
{
    for ( int i = 0; i < def->vertex_count; ++i )
    {
        b->x[i] = b->p[i] = def->positions[i];
        b->mass[i] = def->mass[i];
        b->w[i] = def->pinned != NULL && def->pinned[i] ? 0.0 : 1.0 / def->mass[i];
        b->total_mass += def->mass[i];
    }
    memcpy( b->triangles, def->triangles, 3 * (size_t)def->triangle_count * sizeof( int ) );
    if ( def->outlet_count > 0 )
    {
        memcpy( b->outlet, def->outlet, (size_t)def->outlet_count * sizeof( int ) );
    }
    copy_links( b->x, def->structural, def->structural_count, b->structural );
    copy_links( b->x, def->bend, def->bend_count, b->bend );
}

// A closed skin needs no caps and uses the plain equations.
static bool cap( balloon_oracle* b )
{
    balloon_mesh mesh = { b->vertex_count, b->triangle_count, b->x, b->triangles };
    bool made = balloon_oracle_make_caps( &mesh, &b->caps );
    if ( made && b->caps.hub_count == 0 )
    {
        balloon_oracle_destroy_caps( &b->caps );
    }
    return made;
}

wisp_status balloon_oracle_create( const balloon_oracle_def* def, const balloon_oracle_options* options,
                                   balloon_oracle* out, wisp_error* error )
{
    balloon_oracle made = { .options = *options,
                            .vertex_count = def->vertex_count,
                            .triangle_count = def->triangle_count,
                            .structural_count = def->structural_count,
                            .bend_count = def->bend_count,
                            .outlet_count = def->outlet_count,
                            .q = { 1.0, 0.0, 0.0, 0.0 } };
    if ( !allocate( def, &made ) )
    {
        balloon_oracle_destroy( &made );
        return refuse( error, WISP_NO_MEMORY, "out of memory for a balloon of %d vertices", def->vertex_count );
    }
    copy_def( def, &made );
    if ( def->allow_open && !cap( &made ) )
    {
        balloon_oracle_destroy( &made );
        return refuse( error, WISP_BAD_INPUT, "a border is no simple loop" );
    }
    made.rest_volume = balloon_oracle_present_volume( &made );
    made.volume = made.gas_volume = made.rest_volume;
    made.centre = balloon_oracle_centre( made.x, made.mass, made.vertex_count );
    *out = made;
    return WISP_OK;
}

wisp_status balloon_oracle_create_from_mesh( const balloon_mesh* mesh, double areal_density, int outlet_vertex,
                                             const balloon_oracle_options* options, balloon_oracle* out,
                                             wisp_error* error )
{
    balloon_mesh_topology topology;
    if ( !balloon_mesh_build_topology( mesh, &topology ) )
    {
        return refuse( error, WISP_NO_MEMORY, "out of memory for the edges of %d triangles", mesh->triangle_count );
    }
    int* pairs = calloc( 4 * (size_t)topology.edge_count + 1, sizeof( int ) );
    double* mass = calloc( (size_t)mesh->vertex_count + 1, sizeof( double ) );
    wisp_status status = WISP_NO_MEMORY;
    if ( pairs == NULL || mass == NULL )
    {
        refuse( error, WISP_NO_MEMORY, "out of memory for a mesh of %d vertices", mesh->vertex_count );
    }
    else
    {
        balloon_oracle_def def = { .vertex_count = mesh->vertex_count,
                                   .triangle_count = mesh->triangle_count,
                                   .positions = mesh->positions,
                                   .mass = mass,
                                   .triangles = mesh->triangles,
                                   .structural = pairs,
                                   .outlet = &outlet_vertex,
                                   .outlet_count = outlet_vertex < 0 ? 0 : 1 };
        balloon_oracle_masses( mesh->positions, mesh->vertex_count, mesh->triangles, mesh->triangle_count,
                               areal_density, mass );
        def.structural_count = balloon_mesh_structural_pairs( &topology, pairs );
        def.bend = pairs + 2 * topology.edge_count;
        def.bend_count = balloon_mesh_bend_pairs( &topology, pairs + 2 * topology.edge_count );
        status = balloon_oracle_create( &def, options, out, error );
    }
    free( pairs );
    free( mass );
    balloon_mesh_destroy_topology( &topology );
    return status;
}

// ---- body ----

static const double3 zero = { 0.0, 0.0, 0.0 };

// Measured values.

double balloon_oracle_present_volume( const balloon_oracle* b )
{
    balloon_oracle_caps caps = b->caps;
    return caps.hub_count > 0 ? balloon_oracle_capped_volume( &caps, b->x )
                              : constraint_oracle_volume( b->x, b->triangles, b->triangle_count );
}

// After a collapse Eq. 9 still needs a volume above zero.
static double usable_volume( const balloon_oracle* b )
{
    return fmax( balloon_oracle_present_volume( b ), 1e-3 * b->rest_volume );
}

// P - P_atm by one of the readings, from the present x and the last substep's lambda; the virial is clamped at
// 0.
static double balloon_oracle_gauge( const balloon_oracle* b, balloon_oracle_reading reading )
{
    const balloon_oracle_options* o = &b->options;
    double volume = usable_volume( b ), sum;
    switch ( reading )
    {
        case BALLOON_ORACLE_PRESSURE_GAS:
            return o->atmosphere * ( b->gas_volume - volume ) / volume;
        case BALLOON_ORACLE_PRESSURE_MULTIPLIER:
            return b->h > 0.0 ? b->volume_lambda / ( b->h * b->h ) : 0.0;
        case BALLOON_ORACLE_PRESSURE_ADDED:
            return balloon_oracle_gas_pressure_printed( b->gas_volume - b->rest_volume, volume, o->temperature ) -
                   o->atmosphere;
        case BALLOON_ORACLE_PRESSURE_VIRIAL:
            break;
    }
    sum = balloon_oracle_virial( b->x, b->structural, b->structural_count, o->structural_stiffness ) +
          balloon_oracle_virial( b->x, b->bend, b->bend_count, o->bend_stiffness );
    return fmax( 0.0, sum / ( 3.0 * volume ) );
}

// Step 1 of section 4.
static void measure( balloon_oracle* b )
{
    double volume = balloon_oracle_present_volume( b );
    b->volume = usable_volume( b );
    b->counters.clamped_volumes += b->volume > volume ? 1 : 0;
    b->centre = balloon_oracle_centre( b->x, b->mass, b->vertex_count );
    b->counters.zero_normals +=
        balloon_oracle_skin( b->x, b->vertex_count, b->triangles, b->triangle_count, b->normal, b->area );
}

// The centre of the outlet, and its normal: the sum of its vertices' area vectors, zero where they cancel.
static void find_outlet( balloon_oracle* b )
{
    double3 sum = zero, place = zero;
    double area = 0.0;
    for ( int n = 0; n < b->outlet_count; ++n )
    {
        int vertex = b->outlet[n];
        for ( int c = 0; c < 3 * b->triangle_count; ++c )
        {
            const int* corner = b->triangles + c - c % 3;
            double3 a = b->x[corner[0]];
            double3 s = double3_cross( double3_sub( b->x[corner[1]], a ), double3_sub( b->x[corner[2]], a ) );
            sum = b->triangles[c] == vertex ? double3_add( sum, s ) : sum;
            area += b->triangles[c] == vertex ? double3_length( s ) : 0.0;
        }
        place = double3_add_scaled( place, 1.0 / b->outlet_count, b->x[vertex] );
    }
    double length = double3_length( sum );
    b->outlet_place = place;
    b->outlet_normal = length > 1e-12 * area ? double3_scale( 1.0 / length, sum ) : zero;
}

// Step 3: pressure, hysteresis and outlet speed.
static void read_pressure( balloon_oracle* b )
{
    const balloon_oracle_options* o = &b->options;
    b->gauge = balloon_oracle_gauge( b, o->pressure );
    bool may = o->use_jet && o->outlet_open && b->outlet_count > 0;
    bool runs = may && balloon_oracle_jet_runs( b->jet_on, b->gauge, o->atmosphere, o->close_at, o->open_at );
    b->counters.jet_starts += runs && !b->jet_on ? 1 : 0;
    b->start_gauge = runs && !b->jet_on ? b->gauge : b->start_gauge;
    b->jet_on = runs;
    double density = balloon_oracle_density( o->atmosphere, o->gas_molar_mass, o->temperature );
    double speed = o->outlet == BALLOON_ORACLE_OUTLET_START
                       ? balloon_oracle_outlet_speed_printed( b->start_gauge, b->gauge, density )
                       : balloon_oracle_outlet_speed( b->gauge, density );
    b->outlet_speed = runs ? speed : 0.0;
    b->counters.fast_outlets += b->outlet_speed > 300.0 ? 1 : 0;
}

// Step 3, the gas that leaves within one substep. It is at most what V_0 has above its guard, and the reaction
// follows the amount that leaves.
static void let_gas_out( balloon_oracle* b, double h )
{
    const balloon_oracle_options* o = &b->options;
    b->mass_flow = 0.0;
    if ( !b->jet_on )
    {
        return;
    }
    find_outlet( b );
    if ( double3_length( b->outlet_normal ) == 0.0 )
    {
        b->counters.silent_outlets += 1;
        return;
    }
    double density = balloon_oracle_density( o->atmosphere, o->gas_molar_mass, o->temperature );
    double requested = balloon_oracle_mass_flow( density, o->outlet_area, b->outlet_speed );
    double most = density * fmax( 0.0, b->gas_volume - o->min_volume * b->rest_volume ) / h;
    b->mass_flow = fmin( requested, most );
    b->gas_volume -= b->mass_flow / density * h;
    b->gas_lost += b->mass_flow * h;
}

static double3 fraction( const balloon_oracle* b, int i, double3 force )
{
    return double3_scale( b->mass[i] / b->total_mass, force );
}

// Step 4. Buoyancy and jet are distributed by mass, which gives no torque about the centre.
static void gather_forces( balloon_oracle* b, double h )
{
    const balloon_oracle_options* o = &b->options;
    double air = balloon_oracle_density( o->atmosphere, o->air_molar_mass, o->temperature );
    double gas = balloon_oracle_density( o->atmosphere, o->gas_molar_mass, o->temperature );
    balloon_oracle_forces f = { zero, zero, zero, zero };
    f.gravity = o->use_gravity ? double3_scale( b->total_mass, o->gravity ) : zero;
    f.buoyancy = o->use_buoyancy ? balloon_oracle_buoyancy( o->gravity, b->volume, air, gas ) : zero;
    f.jet = b->jet_on ? balloon_oracle_reaction( b->mass_flow, b->outlet_speed, b->outlet_normal ) : zero;
    for ( int i = 0; i < b->vertex_count; ++i )
    {
        double c = 0.5 * air * o->drag_coefficient * b->area[i];
        double limit_rate = o->limit_drag ? h * b->w[i] : 0.0;
        double3 drag =
            o->use_drag ? balloon_oracle_drag_force( o->drag, c, b->v[i], b->normal[i], limit_rate ) : zero;
        f.drag = double3_add( f.drag, drag );
        b->force[i] =
            double3_add( fraction( b, i, double3_add( f.gravity, double3_add( f.buoyancy, f.jet ) ) ), drag );
    }
    b->forces = f;
    b->jet_impulse = double3_add( b->jet_impulse, double3_scale( h, f.jet ) );
}

// Step 5.
static void spin( balloon_oracle* b, double h )
{
    if ( b->jet_on )
    {
        balloon_oracle_matrix inertia = balloon_oracle_inertia( b->x, b->mass, b->vertex_count, b->centre );
        double3 torque = balloon_oracle_torque( b->outlet_place, b->centre, b->forces.jet );
        double3 increment = balloon_oracle_spin_increment( &inertia, torque, h );
        if ( b->options.spin == BALLOON_ORACLE_SPIN_KICK )
        {
            balloon_oracle_spin_kick( b->x, b->v, b->w, b->vertex_count, b->centre, increment );
        }
        else
        {
            b->omega = double3_add( b->omega, increment );
        }
    }
    if ( b->options.spin == BALLOON_ORACLE_SPIN_PRINTED )
    {
        balloon_oracle_quaternion still = { 1.0, 0.0, 0.0, 0.0 };
        balloon_oracle_quaternion step = balloon_oracle_turn( still, b->omega, h );
        for ( int i = 0; i < b->vertex_count; ++i )
        {
            double3 turned = balloon_oracle_rotate( step, double3_sub( b->x[i], b->centre ) );
            b->x[i] = b->w[i] > 0.0 ? double3_add( b->centre, turned ) : b->x[i];
        }
    }
}

static void project_links( balloon_oracle* b, balloon_oracle_link* links, int count, double k, double stiffness )
{
    bool compliant = b->options.volume == BALLOON_ORACLE_VOLUME_XPBD;
    double alpha = 1.0 / ( stiffness * b->h * b->h );
    for ( int e = 0; e < count; ++e )
    {
        const int ends[2] = { links[e].a, links[e].b };
        constraint_oracle_term term = constraint_oracle_distance( b->p[ends[0]], b->p[ends[1]], links[e].rest );
        if ( compliant )
        {
            constraint_oracle_project_compliant( &term, ends, b->w, alpha, &links[e].lambda, b->p,
                                                 &b->counters.skips );
        }
        else
        {
            links[e].lambda += constraint_oracle_project( &term, ends, b->w, k, b->p, &b->counters.skips );
        }
    }
}

static void project_volume( balloon_oracle* b )
{
    const balloon_oracle_options* o = &b->options;
    constraint_oracle_skips* skips = &b->counters.skips;
    bool compliant = o->volume == BALLOON_ORACLE_VOLUME_XPBD;
    if ( b->caps.hub_count > 0 )
    {
        double alpha = compliant ? b->gas_volume / o->atmosphere / ( b->h * b->h ) : 0.0;
        balloon_oracle_project_capped( &b->caps, b->p, b->w, b->gas_volume, compliant ? 1.0 : o->volume_k, alpha,
                                       &b->volume_lambda, b->gradient, skips );
    }
    else if ( compliant )
    {
        double alpha = b->gas_volume / o->atmosphere / ( b->h * b->h );
        constraint_oracle_project_volume_compliant( b->p, b->w, b->vertex_count, b->triangles, b->triangle_count,
                                                    b->gas_volume, alpha, &b->volume_lambda, b->gradient, skips );
    }
    else
    {
        b->volume_lambda +=
            constraint_oracle_project_volume( b->p, b->w, b->vertex_count, b->triangles, b->triangle_count,
                                              b->gas_volume, o->volume_k, b->gradient, skips );
    }
}

static void forget_lambdas( balloon_oracle* b )
{
    b->volume_lambda = 0.0;
    for ( int e = 0; e < b->structural_count; ++e )
    {
        b->structural[e].lambda = 0.0;
    }
    for ( int e = 0; e < b->bend_count; ++e )
    {
        b->bend[e].lambda = 0.0;
    }
}

static const double turn_max = 0.5; // rad, more is no small turn: the body was crushed, and keeps what it got

// Projections have moved the predicted positions by D and so added sum m (x - c) x D / h to the angular momentum. A small
// rotation t of the body about its new centre takes it away: sum m (x - c) x (t x (p - c')) = -sum m (x - c) x D.
static void take_back_turn( balloon_oracle* b )
{
    double3 c = balloon_oracle_centre( b->x, b->mass, b->vertex_count );
    double3 after = balloon_oracle_centre( b->p, b->mass, b->vertex_count );
    const double3 axis[3] = { { 1.0, 0.0, 0.0 }, { 0.0, 1.0, 0.0 }, { 0.0, 0.0, 1.0 } };
    double3 column[3] = { zero, zero, zero }, added = zero;
    for ( int i = 0; i < b->vertex_count; ++i )
    {
        double3 arm = double3_scale( b->mass[i], double3_sub( b->x[i], c ) );
        for ( int k = 0; k < 3; ++k )
        {
            double3 turned = double3_cross( axis[k], double3_sub( b->p[i], after ) );
            column[k] = double3_add( column[k], double3_cross( arm, turned ) );
        }
        added = double3_add( added, double3_cross( arm, double3_sub( b->p[i], b->predicted[i] ) ) );
    }
    // the matrix is not symmetric, so it is inverted through its rows: t_k = -(row_k . added) / det
    double3 row[3] = { double3_cross( column[1], column[2] ), double3_cross( column[2], column[0] ),
                       double3_cross( column[0], column[1] ) };
    double determinant = double3_dot( column[0], row[0] );
    if ( determinant == 0.0 )
    {
        return;
    }
    double3 turn =
        double3_scale( -1.0 / determinant, double3_make( double3_dot( row[0], added ), double3_dot( row[1], added ),
                                                         double3_dot( row[2], added ) ) );
    if ( double3_length( turn ) > turn_max )
    {
        return;
    }
    for ( int i = 0; i < b->vertex_count; ++i )
    {
        b->p[i] = double3_add( b->p[i], double3_cross( turn, double3_sub( b->p[i], after ) ) );
    }
}

static bool is_free( const balloon_oracle* b )
{
    bool free_of_pins = true;
    for ( int i = 0; i < b->vertex_count; ++i )
    {
        free_of_pins = free_of_pins && b->w[i] > 0.0;
    }
    return free_of_pins;
}

// Steps 6 to 8.
static void move( balloon_oracle* b, double h )
{
    const balloon_oracle_options* o = &b->options;
    for ( int i = 0; i < b->vertex_count; ++i )
    {
        b->p[i] = b->predicted[i] = balloon_oracle_predict( b->x[i], b->v + i, b->w[i], b->force[i], h );
    }
    forget_lambdas( b );
    for ( int n = 0; n < o->iterations; ++n )
    {
        project_links( b, b->structural, b->structural_count, o->structural_k, o->structural_stiffness );
        project_links( b, b->bend, b->bend_count, o->bend_k, o->bend_stiffness );
        project_volume( b );
    }
    if ( o->keep_angular_momentum && is_free( b ) )
    {
        take_back_turn( b );
    }
    double keep = exp( -o->velocity_decay * h );
    for ( int i = 0; i < b->vertex_count; ++i )
    {
        b->v[i] = double3_scale( keep, balloon_oracle_velocity( b->x[i], b->p[i], h ) );
        b->x[i] = b->p[i];
    }
}

// Step 9: the orientation follows the particles; `printed` follows its own accumulated omega.
static void diagnose( balloon_oracle* b, double h )
{
    if ( b->options.spin == BALLOON_ORACLE_SPIN_KICK )
    {
        double3 c = balloon_oracle_centre( b->x, b->mass, b->vertex_count );
        balloon_oracle_matrix inertia = balloon_oracle_inertia( b->x, b->mass, b->vertex_count, c );
        double3 momentum = balloon_oracle_angular_momentum( b->x, b->v, b->mass, b->vertex_count, c );
        b->omega = balloon_oracle_spin_increment( &inertia, momentum, 1.0 );
    }
    b->q = balloon_oracle_turn( b->q, b->omega, h );
    b->time += h;
}

void balloon_oracle_step( balloon_oracle* b )
{
    const balloon_oracle_options* o = &b->options;
    double h = o->dt / o->substeps;
    for ( int n = 0; n < o->substeps; ++n )
    {
        measure( b );
        b->gas_volume = fmax( b->gas_volume + o->inflow * h, o->min_volume * b->rest_volume );
        if ( n == 0 || !o->update_per_frame )
        {
            read_pressure( b );
        }
        let_gas_out( b, h );
        b->h = h;
        gather_forces( b, h );
        spin( b, h );
        move( b, h );
        diagnose( b, h );
    }
}
