// Makes the reference files of `wisp bench cloth --compare`: each scene twice, with steps of 1/rate and 2/rate. The
// finer run is kept, with the distance between the two at every sample. Then the references of `wisp bench accuracy`.
#include "accuracy_references.h"
#include "reference_run.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct reference_arguments
{
    const char* folder;
    const char* scene; // null: all
    double rate;       // 0: the default of the scene
    double rest_rate;
    bool has_rest, euler;
} reference_arguments;

static const char usage[] =
    "usage: wisp_reference [--scene NAME] [--rate N] [--rest-rate N] [--no-rest] [--euler] FOLDER\n"
    "Write FOLDER/NAME.reference for every scene of the comparison and of the case accuracy that has no closed "
    "form,\n"
    "or for one. Options but --scene are of the comparison.\n"
    "  --rate N       steps a second in the window, default 16000 with a ball and 8000 without;\n"
    "                 the other run has half of it\n"
    "  --rest-rate N  and after it, default 400\n"
    "  --no-rest      stop behind the window; for experiments, nothing is written\n"
    "  --euler        implicit Euler in place of BDF2\n";

static bool parse_rate( const char* word, double* out )
{
    char* end;
    *out = word ? strtod( word, &end ) : 0.0;
    // an even number of steps between two samples, for the run of half the rate too
    return word && *end == '\0' && *out >= 80.0 && *out <= 1e6 && *out == 40.0 * (double)(long)( *out / 40.0 );
}

static bool parse( int count, char** words, reference_arguments* out )
{
    *out = ( reference_arguments ){ .rest_rate = 400.0, .has_rest = true };
    for ( int i = 1; i < count; ++i )
    {
        const char *word = words[i], *next = i + 1 < count ? words[i + 1] : NULL;
        bool good = true;
        if ( strcmp( word, "--scene" ) == 0 )
        {
            out->scene = next;
            good = next != NULL;
            ++i;
        }
        else if ( strcmp( word, "--rate" ) == 0 || strcmp( word, "--rest-rate" ) == 0 )
        {
            good = parse_rate( next, strcmp( word, "--rate" ) == 0 ? &out->rate : &out->rest_rate );
            ++i;
        }
        else if ( strcmp( word, "--no-rest" ) == 0 )
        {
            out->has_rest = false;
        }
        else if ( strcmp( word, "--euler" ) == 0 )
        {
            out->euler = true;
        }
        else
        {
            good = word[0] != '-' && !out->folder;
            out->folder = word;
        }
        if ( !good )
        {
            return false;
        }
    }
    return out->folder != NULL;
}

static void print_observations( const compare_scene* scene, const compare_reference* reference )
{
    printf( "%s: mesh of %d vertices, seed %d, hash %016llx\n", scene->physics.name, reference->vertex_count,
            COMPARE_SEED, (unsigned long long)reference->mesh_hash );
    printf( "  time s   height m   strain %%    energy J   slack   uncertainty mm\n" );
    for ( int k = 0; k < reference->observation_count; ++k )
    {
        const compare_reference_observation* l = &reference->observations[k];
        printf( "%8.2f %10.5f %10.4f %11.6f %7.0f %10.5f\n", l->time, l->observation.hem,
                100.0 * l->observation.strain, l->observation.energy, l->observation.slack, 1e3 * l->uncertainty );
    }
    fflush( stdout );
}

static wisp_status make( const reference_arguments* arguments, compare_scenario scenario, wisp_error* error )
{
    compare_scene scene;
    compare_reference coarse = { .points = NULL }, fine = { .points = NULL };
    double *coarse_points = NULL, *fine_points = NULL;
    wisp_status status = compare_scene_make( scenario, TRIANGLE_VERTICES, &scene, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    const double rate = arguments->rate > 0.0 ? arguments->rate : scene.physics.has_ball ? 16000.0 : 8000.0;
    reference_plan plan = { .integrator = arguments->euler ? TRIANGLE_ORACLE_EULER : TRIANGLE_ORACLE_BDF2,
                            .rate = 0.5 * rate,
                            .rest_rate = 0.5 * arguments->rest_rate,
                            .has_rest = arguments->has_rest };
    status = reference_run( &scene, &plan, &coarse, &coarse_points, error );
    plan.rate = rate;
    plan.rest_rate = arguments->rest_rate;
    status = status == WISP_OK ? reference_run( &scene, &plan, &fine, &fine_points, error ) : status;
    if ( status == WISP_OK )
    {
        fine.scenario = (int)scenario;
        for ( int k = 0; k < fine.observation_count; ++k )
        {
            const size_t at = 3 * (size_t)k * (size_t)fine.vertex_count;
            fine.observations[k].uncertainty =
                reference_distance( coarse_points + at, fine_points + at, fine.vertex_count );
        }
        print_observations( &scene, &fine );
    }
    if ( status == WISP_OK && arguments->has_rest )
    {
        char path[1024];
        snprintf( path, sizeof( path ), "%s/%s.reference", arguments->folder, scene.physics.name );
        status = compare_reference_write( &fine, path, error );
    }
    compare_reference_free( &coarse );
    compare_reference_free( &fine );
    free( coarse_points );
    free( fine_points );
    compare_scene_free( &scene );
    return status;
}

// ---- the case accuracy ----

typedef struct accuracy_item
{
    const char* name;
    accuracy_reference_fn* make;
} accuracy_item;

static const accuracy_item accuracy_items[] = {
    { "hanging_cloth", reference_of_hanging_cloth },   { "flag", reference_of_flag },
    { "balloon_flight", reference_of_balloon_flight }, { "balloon_meshes", reference_of_balloon_meshes },
    { "strands_swing", reference_of_strands_swing },   { "strands_guides", reference_of_strands_guides },
    { "frozen_clumps", reference_of_frozen_clumps },
};

static wisp_status make_accuracy( const reference_arguments* arguments, const accuracy_item* item, wisp_error* error )
{
    accuracy_reference reference = { .numbers = NULL };
    const double begin = wisp_clock_seconds();
    wisp_status status = item->make( &reference, error );
    status = status == WISP_OK ? accuracy_reference_write( &reference, arguments->folder, error ) : status;
    accuracy_reference_free( &reference );
    printf( "%s: %.1f s\n", item->name, wisp_clock_seconds() - begin );
    fflush( stdout );
    return status;
}

// ---- the program ----

static bool is_chosen( const reference_arguments* arguments, const char* name )
{
    return !arguments->scene || strcmp( arguments->scene, name ) == 0;
}

static int fail( const char* name, const wisp_error* error )
{
    fprintf( stderr, "wisp_reference: %s: %s\n", name, error->message );
    return 1;
}

static int make_chosen( const reference_arguments* arguments )
{
    wisp_error error = { 0 };
    int count = 0;
    for ( int scenario = 0; scenario < COMPARE_SCENARIO_COUNT; ++scenario )
    {
        const char* name = compare_physics_of( (compare_scenario)scenario ).name;
        const bool chosen = is_chosen( arguments, name );
        count += chosen;
        if ( chosen && make( arguments, (compare_scenario)scenario, &error ) != WISP_OK )
        {
            return fail( name, &error );
        }
    }
    for ( int i = 0; i < WISP_COUNT( accuracy_items ); ++i )
    {
        const bool chosen = is_chosen( arguments, accuracy_items[i].name );
        count += chosen;
        if ( chosen && make_accuracy( arguments, &accuracy_items[i], &error ) != WISP_OK )
        {
            return fail( accuracy_items[i].name, &error );
        }
    }
    if ( count == 0 )
    {
        fprintf( stderr, "wisp_reference: there is no scene '%s' that has a reference to be made\n",
                 arguments->scene );
        return 64;
    }
    return 0;
}

int main( int argc, char** argv )
{
    reference_arguments arguments;
    if ( !parse( argc, argv, &arguments ) )
    {
        fputs( usage, stderr );
        return 64;
    }
    return make_chosen( &arguments );
}
