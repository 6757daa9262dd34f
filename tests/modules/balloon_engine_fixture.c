#include "balloon_engine_fixture.h"

// ---- scenes ----

balloon_scene balloon_scene_of( const balloon_mesh* mesh )
{
    balloon_scene scene = {
        .mesh = mesh,
        .scale = 1.0,
        .area_density = 0.02f,
        .bend_links = true,
        .def = wisp_default_balloon_def(),
        .dt = 1.0f / 60.0f,
        .substeps = 10,
        .iterations = 2,
        .workers = 1,
    };
    scene.def.buoyancy = false;
    scene.def.drag_coefficient = 0.0f;
    return scene;
}

balloon_scene balloon_scene_in_air( const balloon_mesh* mesh )
{
    balloon_scene scene = balloon_scene_of( mesh );
    scene.gravity = ( wisp_vec3 ){ 0.0f, -9.8f, 0.0f };
    scene.def.buoyancy = true;
    scene.def.drag_coefficient = 0.5f;
    return scene;
}

void balloon_scene_give_outlet( balloon_scene* scene, int vertex, bool open )
{
    scene->def.outlet_count = 1;
    scene->def.outlet[0] = vertex;
    scene->def.outlet_open = open;
}

void balloon_scene_give_outlet_around( balloon_scene* scene, int vertex, double radius )
{
    const balloon_mesh* mesh = scene->mesh;
    scene->def.outlet_count = 0;
    for ( int v = 0; v < mesh->vertex_count && scene->def.outlet_count < WISP_BALLOON_MAX_OUTLET; ++v )
    {
        if ( double3_distance( mesh->positions[v], mesh->positions[vertex] ) <= radius )
        {
            scene->def.outlet[scene->def.outlet_count++] = v;
        }
    }
}

balloon_mesh balloon_sphere( int level, double radius )
{
    balloon_mesh mesh;
    assert_true( balloon_mesh_icosphere( &mesh, level, radius ) );
    return mesh;
}

balloon_mesh balloon_pear( int level )
{
    balloon_mesh mesh;
    assert_true( balloon_mesh_pear( &mesh, level, 0.15 ) );
    return mesh;
}

// ---- worlds ----

static void forget( void* user, wisp_log_level level, const char* message )
{
    (void)user;
    (void)level;
    (void)message;
}

static void expect_ok( const wisp_world* world, wisp_status status )
{
    if ( status != WISP_OK )
    {
        fail_msg( "%s", wisp_world_message( world ) );
    }
}

wisp_world* balloon_world_create( const balloon_scene* scene )
{
    static const wisp_module* const MODULES[] = { &wisp_balloon_module };
    wisp_world_def def = wisp_default_world_def();
    def.modules = MODULES;
    def.module_count = WISP_COUNT( MODULES );
    def.log = forget;
    def.workers = 1;
    if ( scene != NULL )
    {
        def.workers = scene->workers;
        def.isa = scene->isa;
        def.parallel_for = scene->parallel_for;
        def.parallel_for_user = scene->parallel_for_user;
        def.substeps = scene->substeps;
        def.iterations = scene->iterations;
        def.allocator = scene->allocator.allocate != NULL ? scene->allocator : def.allocator;
    }
    wisp_world* world;
    wisp_error error = { 0 };
    if ( wisp_world_create( &def, &world, &error ) != WISP_OK )
    {
        fail_msg( "no world: %s", error.message );
    }
    return world;
}

static wisp_vec3* rounded_points( const balloon_scene* scene, double scale, wisp_vec3 place )
{
    const balloon_mesh* mesh = scene->mesh;
    wisp_vec3* points = checked_calloc( (size_t)mesh->vertex_count, sizeof( wisp_vec3 ) );
    for ( int v = 0; v < mesh->vertex_count; ++v )
    {
        double3 p = double3_scale( scale, mesh->positions[v] );
        points[v] = ( wisp_vec3 ){ (float)( p.x + (double)place.x ), (float)( p.y + (double)place.y ),
                                   (float)( p.z + (double)place.z ) };
    }
    return points;
}

static wisp_fabric* cook( const balloon_scene* scene )
{
    SCOPED( free_local ) wisp_vec3* points = rounded_points( scene, 1.0, ( wisp_vec3 ){ 0.0f, 0.0f, 0.0f } );
    wisp_fabric_def def = wisp_default_fabric_def();
    def.points = points;
    def.triangles = scene->mesh->triangles;
    def.vertex_count = scene->mesh->vertex_count;
    def.triangle_count = scene->mesh->triangle_count;
    def.bend_links = scene->bend_links;
    wisp_fabric* fabric;
    wisp_error error = { 0 };
    if ( wisp_fabric_cook( &def, NULL, &fabric, &error ) != WISP_OK )
    {
        fail_msg( "no fabric: %s", error.message );
    }
    return fabric;
}

wisp_entity balloon_surface_add( wisp_world* world, const balloon_scene* scene )
{
    wisp_surface_def def = support_weightless_surface_def();
    wisp_vec3* points = rounded_points( scene, scene->scale, scene->place );
    def.fabric = cook( scene );
    def.points = points;
    def.area_density = scene->area_density;
    def.pins = scene->pins;
    def.pin_count = scene->pin_count;
    wisp_entity entity;
    expect_ok( world, wisp_add_surface( world, &def, &entity ) );
    wisp_fabric_release( def.fabric );
    free( points );
    expect_ok( world, wisp_set_gravity( world, entity, scene->gravity ) );
    expect_ok( world, wisp_set_damping( world, entity, scene->damping ) );
    return entity;
}

wisp_entity balloon_add( wisp_world* world, const balloon_scene* scene )
{
    wisp_entity entity = balloon_surface_add( world, scene );
    expect_ok( world, wisp_set_balloon( world, entity, &scene->def ) );
    expect_ok( world, wisp_request( world, entity, WISP_SURFACE_POINTS ) );
    expect_ok( world, wisp_request( world, entity, WISP_MOTION_STATS ) );
    expect_ok( world, wisp_request_balloon_stats( world, entity, true ) );
    return entity;
}

// ---- flights ----

balloon_flight balloon_start( const balloon_scene* scene )
{
    wisp_world* world = balloon_world_create( scene );
    return ( balloon_flight ){ world, balloon_add( world, scene ), scene };
}

void balloon_end( balloon_flight* flight )
{
    wisp_world_destroy( flight->world );
    *flight = ( balloon_flight ){ 0 };
}

void balloon_steps( const balloon_flight* flight, int steps )
{
    for ( int i = 0; i < steps; ++i )
    {
        expect_ok( flight->world, wisp_world_step( flight->world, flight->scene->dt ) );
    }
}

wisp_balloon_stats balloon_read( const balloon_flight* flight )
{
    wisp_balloon_stats stats;
    expect_ok( flight->world, wisp_read_balloon_stats( flight->world, flight->entity, &stats ) );
    return stats;
}

wisp_motion_stats balloon_motion_stats( const balloon_flight* flight )
{
    wisp_motion_stats motion_stats;
    expect_ok( flight->world, wisp_read_motion_stats( flight->world, flight->entity, &motion_stats ) );
    return motion_stats;
}

double3 balloon_from( const double v[3] )
{
    return double3_make( v[0], v[1], v[2] );
}

float* balloon_positions( const balloon_flight* flight )
{
    return wisp_world_column( flight->world, flight->entity, WISP_PARTICLE_POSITION, 0 );
}

float* balloon_velocities( const balloon_flight* flight )
{
    return wisp_world_column( flight->world, flight->entity, WISP_PARTICLE_VELOCITY, 0 );
}

static double mass_of( const float* p )
{
    return p[3] > 0.0f ? 1.0 / (double)p[3] : 0.0;
}

// The sums below use the present columns, not the statistics of the last step.

static int count_of( const balloon_flight* flight )
{
    return wisp_world_fabric( flight->world, flight->entity )->vertex_count;
}

double3 balloon_momentum( const balloon_flight* flight )
{
    const float *x = balloon_positions( flight ), *v = balloon_velocities( flight );
    double3 sum = { 0.0, 0.0, 0.0 };
    for ( int i = 0; i < 4 * count_of( flight ); i += 4 )
    {
        sum = double3_add( sum, double3_scale( mass_of( x + i ), double3_from( v + i ) ) );
    }
    return sum;
}

double3 balloon_angular_momentum( const balloon_flight* flight )
{
    const float *x = balloon_positions( flight ), *v = balloon_velocities( flight );
    double3 sum = { 0.0, 0.0, 0.0 }, centre = sum;
    double mass = 0.0;
    for ( int i = 0; i < 4 * count_of( flight ); i += 4 )
    {
        centre = double3_add( centre, double3_scale( mass_of( x + i ), double3_from( x + i ) ) );
        mass += mass_of( x + i );
    }
    centre = double3_scale( 1.0 / mass, centre );
    for ( int i = 0; i < 4 * count_of( flight ); i += 4 )
    {
        double3 r = double3_sub( double3_from( x + i ), centre );
        sum = double3_add( sum, double3_scale( mass_of( x + i ), double3_cross( r, double3_from( v + i ) ) ) );
    }
    return sum;
}

void balloon_stir( const balloon_flight* flight, float speed )
{
    const wisp_fabric* fabric = wisp_world_fabric( flight->world, flight->entity );
    const float* x = balloon_positions( flight );
    float* v = balloon_velocities( flight );
    for ( int slot = 0; slot < fabric->vertex_count; ++slot )
    {
        for ( int k = 0; k < 3 && x[4 * slot + 3] > 0.0f; ++k )
        {
            v[4 * slot + k] = test_random_float( fabric->slot_vertex[slot], k, -speed, speed );
        }
    }
}

void balloon_throw( const balloon_flight* flight, wisp_vec3 velocity )
{
    const wisp_vec3 still = { 0.0f, 0.0f, 0.0f };
    expect_ok( flight->world, wisp_set_velocity( flight->world, flight->entity, velocity, still ) );
}

bool balloon_is_finite( const balloon_flight* flight )
{
    const float *x = balloon_positions( flight ), *v = balloon_velocities( flight );
    bool finite = wisp_is_halted( flight->world, flight->entity ) == false;
    for ( int i = 0; i < 4 * count_of( flight ); ++i )
    {
        finite = finite && isfinite( x[i] ) && isfinite( v[i] );
    }
    return finite;
}

uint64_t balloon_hash( const balloon_flight* flight )
{
    uint64_t hash;
    expect_ok( flight->world, wisp_world_hash_column( flight->world, flight->entity, WISP_SURFACE_POINTS, &hash ) );
    return hash;
}

// ---- the oracle ----

static balloon_oracle_options oracle_options( const balloon_scene* s )
{
    const wisp_balloon_def* d = &s->def;
    balloon_oracle_options o = balloon_oracle_default_options();
    assert_int_equal( d->solver, d->volume ); // the oracle has one switch for both
    double h = (double)s->dt / s->substeps;
    o.dt = (double)s->dt;
    o.substeps = s->substeps;
    o.iterations = s->iterations;
    o.volume = d->volume == WISP_SOLVER_PBD ? BALLOON_ORACLE_VOLUME_PBD : BALLOON_ORACLE_VOLUME_XPBD;
    o.keep_angular_momentum = true;
    o.atmosphere = (double)d->atmospheric_pressure;
    o.temperature = (double)d->temperature;
    o.gas_molar_mass = (double)d->gas_molar_mass;
    o.air_molar_mass = (double)d->air_molar_mass;
    o.use_buoyancy = d->buoyancy;
    o.use_drag = d->drag_coefficient > 0.0f;
    o.gravity = double3_make( (double)s->gravity.x, (double)s->gravity.y, (double)s->gravity.z );
    o.drag_coefficient = (double)d->drag_coefficient;
    o.outlet_area = (double)d->outlet_area;
    o.structural_k = (double)d->stretch_stiffness;
    o.bend_k = (double)d->bend_stiffness;
    o.volume_k = (double)d->volume_stiffness;
    o.structural_stiffness = (double)d->edge_stiffness;
    o.bend_stiffness = (double)d->bend_link_stiffness;
    // the engine decays by 1 / (1 + rate h), the oracle by exp( -decay h )
    o.velocity_decay = log1p( (double)s->damping * h ) / h;
    o.min_volume = (double)d->min_gas_ratio;
    o.inflow = (double)d->inflation_rate;
    o.outlet_open = d->outlet_open;
    return o;
}

// Links of the engine's schedule that are edges, bend links, or both. @return their number
static int list_pairs( const wisp_fabric* f, bool edges, bool crosses, int* pairs, double* rest )
{
    int count = 0;
    for ( int slot = 0; slot < f->link_order.slot_count; ++slot )
    {
        int link = f->link_order.constraint[slot];
        if ( link >= 0 && ( link < f->edge_count ? edges : crosses ) )
        {
            pairs[2 * count] = f->link_a_x4[slot] / 4;
            pairs[2 * count + 1] = f->link_b_x4[slot] / 4;
            rest[count++] = (double)f->link_rest[slot];
        }
    }
    return count;
}

static void* new_memory( int count, size_t size )
{
    void* memory = checked_calloc( (size_t)count + 1, size );
    return memory;
}

// The rest shape, from which the oracle takes its volume.
static void fill_def( const wisp_fabric* f, const float* x, float density, balloon_oracle_def* def )
{
    double3* positions = new_memory( f->vertex_count, sizeof( double3 ) );
    double* mass = new_memory( f->vertex_count, sizeof( double ) );
    bool* pinned = new_memory( f->vertex_count, sizeof( bool ) );
    for ( int slot = 0; slot < f->vertex_count; ++slot )
    {
        const wisp_vec3 p = f->rest[slot];
        positions[slot] = double3_make( (double)p.x, (double)p.y, (double)p.z );
        pinned[slot] = x[4 * slot + 3] == 0.0f;
        mass[slot] = pinned[slot] ? (double)( density * f->area[slot] ) : mass_of( x + 4 * slot );
    }
    def->positions = positions;
    def->mass = mass;
    def->pinned = pinned;
    def->triangles = f->triangles;
    def->vertex_count = f->vertex_count;
    def->triangle_count = f->triangle_count;
}

static void free_def( balloon_oracle_def* def )
{
    free( (void*)def->positions );
    free( (void*)def->mass );
    free( (void*)def->pinned );
    free( (void*)def->structural );
    free( (void*)def->bend );
}

static void copy_state( const balloon_flight* flight, balloon_oracle* b )
{
    const float *x = balloon_positions( flight ), *v = balloon_velocities( flight );
    b->total_mass = 0.0;
    for ( int slot = 0; slot < b->vertex_count; ++slot )
    {
        b->x[slot] = b->p[slot] = double3_from( x + 4 * slot );
        b->v[slot] = double3_from( v + 4 * slot );
        b->w[slot] = (double)x[4 * slot + 3];
        b->mass[slot] = mass_of( x + 4 * slot );
        b->total_mass += b->mass[slot];
    }
    b->gas_volume = (double)flight->scene->def.gas_ratio * b->rest_volume;
}

balloon_oracle balloon_oracle_of( const balloon_flight* flight, balloon_order order )
{
    const wisp_fabric* f = wisp_world_fabric( flight->world, flight->entity );
    const wisp_balloon_def* d = &flight->scene->def;
    bool parted = order == BALLOON_ORDER_PARTED;
    assert_true( parted || f->link_count == f->edge_count ||
                 ( d->edge_stiffness == d->bend_link_stiffness &&
                   ( d->solver == WISP_SOLVER_XPBD || d->stretch_stiffness == d->bend_stiffness ) ) );
    int* pairs[2] = { new_memory( f->link_count, 2 * sizeof( int ) ),
                      new_memory( f->link_count, 2 * sizeof( int ) ) };
    double* rest[2] = { new_memory( f->link_count, sizeof( double ) ),
                        new_memory( f->link_count, sizeof( double ) ) };
    balloon_oracle_def def = { .structural = pairs[0], .bend = pairs[1] };
    def.structural_count = list_pairs( f, true, parted == false, pairs[0], rest[0] );
    def.bend_count = list_pairs( f, false, parted, pairs[1], rest[1] );
    int outlet[WISP_BALLOON_MAX_OUTLET];
    for ( int i = 0; i < d->outlet_count; ++i )
    {
        outlet[i] = f->vertex_slot[d->outlet[i]];
    }
    def.allow_open = d->allow_open;
    def.outlet = outlet;
    def.outlet_count = d->outlet_count;
    fill_def( f, balloon_positions( flight ), flight->scene->area_density, &def );
    const balloon_oracle_options options = oracle_options( flight->scene );
    balloon_oracle oracle;
    wisp_error error = { 0 };
    if ( balloon_oracle_create( &def, &options, &oracle, &error ) != WISP_OK )
    {
        fail_msg( "no oracle: %s", error.message );
    }
    for ( int e = 0; e < oracle.structural_count; ++e )
    {
        oracle.structural[e].rest = rest[0][e];
    }
    for ( int e = 0; e < oracle.bend_count; ++e )
    {
        oracle.bend[e].rest = rest[1][e];
    }
    copy_state( flight, &oracle );
    free_def( &def );
    free( rest[0] );
    free( rest[1] );
    return oracle;
}

double balloon_distance( const balloon_flight* flight, const balloon_oracle* oracle )
{
    const float* x = balloon_positions( flight );
    double largest = 0.0;
    for ( int slot = 0; slot < oracle->vertex_count; ++slot )
    {
        double distance = double3_distance( double3_from( x + 4 * slot ), oracle->x[slot] );
        largest = distance > largest || isnan( distance ) ? distance : largest;
    }
    return largest;
}

// ---- numbers ----

void balloon_assert_close( double actual, double expected, double tolerance )
{
    if ( !( fabs( actual - expected ) <= tolerance ) )
    {
        fail_msg( "%.9g is not %.9g: they differ by %.3g, allowed %.3g", actual, expected, fabs( actual - expected ),
                  tolerance );
    }
}

void balloon_assert_fraction( double actual, double expected, double tolerance )
{
    balloon_assert_close( actual / expected, 1.0, tolerance );
}
