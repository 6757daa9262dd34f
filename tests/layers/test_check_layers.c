// The tree respects its layers; and the check finds planted violations, one at a time.
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include "check_layers.h"

#include <ftw.h>
#include <limits.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static const char* tree_root;

/// A file of a small tree.
typedef struct planted
{
    const char* path;
    const char* text;
    const char* line; ///< beginning of the report after the path; null if there is nothing to find
    const char* word; ///< another part of the report
} planted;

// A valid tree, with an include across every dependency that is allowed.
static const planted clean_tree[] = {
    { "engine/include/wisp/base.h", "#include <stdint.h>\n", NULL, NULL },
    { "engine/include/wisp/jobs.h", "#include \"wisp/base.h\"\n", NULL, NULL },
    { "engine/include/wisp/module/module.h", "#include \"wisp/jobs.h\"\n", NULL, NULL },
    { "engine/meson.build", "subdir('base')\nengine_libs = [base_lib] + kernel_libs + [plan_lib]\n", NULL, NULL },
    { "engine/base/alloc.h", "#include \"wisp/base.h\"\n", NULL, NULL },
    { "engine/math/vec.h", "#include \"alloc.h\"\n", NULL, NULL },
    { "engine/math/lane.h", "#include <immintrin.h>\n__m256 wide;\n", NULL, NULL },
    { "engine/jobs/jobs.h", "#include \"wisp/jobs.h\"\n", NULL, NULL },
    { "engine/jobs/jobs.c", "#include \"jobs.h\"\n#include <omp.h>\n#pragma omp parallel\n", NULL, NULL },
    { "engine/jobs/meson.build", "lib(base_include, dependencies : [openmp_dep])\n", NULL, NULL },
    { "engine/store/store.h", "#include \"wisp/module/module.h\"\n#include \"jobs.h\"\n", NULL, NULL },
    { "engine/space/grid.c", "#include \"vec.h\"\n#include <embree3/rtcore.h>\n", NULL, NULL },
    { "engine/kernels/wide.c", "#include \"lane.h\"\nint x = _mm_cvtsi128_si32( y );\n", NULL, NULL },
    { "engine/kernels/meson.build", "flags = ['-mavx2']\nlib(math_include, kernel_libs)\n", NULL, NULL },
    { "engine/plan/plan.c", "#include \"../store/store.h\"\n#include <stdlib.h>\n", NULL, NULL },
    { "engine/plan/meson.build", "lib(store_include, plan_include, math_lib_dep) # not world_include\n", NULL, NULL },
    { "engine/world/world.c", "// never <omp.h>, never _mm_add_ps\n/* nor\n#include \"main.c\"\n*/\n", NULL, NULL },
    { "modules/frozen_hair/frozen_hair.h", "#include \"wisp/jobs.h\"\n", NULL, NULL },
    { "modules/frozen_hair/own.h", "#include \"frozen_hair.h\"\n#include \"wisp/module/module.h\"\n", NULL, NULL },
    { "modules/frozen_hair/meson.build", "lib(public_include, include_directories('.'))\n", NULL, NULL },
    { "modules/strand_appearance/strand_appearance.c", "#include \"wisp/module/module.h\"\n", NULL, NULL },
    { "app/io/scene.h", "#include \"frozen_hair/frozen_hair.h\"\n#include <yaml.h>\n", NULL, NULL },
    { "app/io/groom.c", "#include \"vec.h\"\n#include \"scene.h\"\n", NULL, NULL },
    { "app/results/rows.h", "#include <jansson.h>\n", NULL, NULL },
    { "modules/modules.inc", "WISP_MODULE( frozen_hair )\n", NULL, NULL },
    { "app/main.c", "#include \"bench.h\"\n#include \"scene.h\"\n#include \"modules.inc\"\n", NULL, NULL },
    { "bench/bench.h",
      "#include \"oracle/reference.h\"\n#include \"rows.h\"\n#include \"scene.h\"\n#include \"facts.h\"\n", NULL,
      NULL },
    { "bench/facts.h.in", "#mesondefine FACTS\n", NULL, NULL },
    { "bench/count.c", "#include \"modules.inc\"\n", NULL, NULL },
    { "examples/embed.c", "#include <wisp/base.h>\n#include <wisp/frozen_hair.h>\n", NULL, NULL },
    { "tests/oracle/reference.h", "#include <math.h>\n", NULL, NULL },
    { "tests/engine/test_plan.c", "#include \"main.c\"\n#include <omp.h>\n__m128 x;\n", NULL, NULL },
};

static const planted violations[] = {
    // dependencies that point up
    { "engine/base/up.c", "\n#include \"vec.h\"\n", ":2:", "vec.h" },
    { "engine/math/up.h", "#include \"jobs.h\"\n", ":1:", "above" },
    { "engine/jobs/up.c", "#include \"store.h\"\n", ":1:", "above" },
    { "engine/store/up.c", "  #  include \"../plan/plan.c\"\n", ":1:", "above" },
    { "engine/store/side.c", "#include \"engine/space/grid.c\"\n", ":1:", "beside" },
    { "engine/plan/up.c", "#include \"world.c\"\n", ":1:", "above" },
    { "engine/base/face.c", "#include \"wisp/module/module.h\"\n", ":1:", "layer above" },
    { "engine/plan/out.c", "#include \"frozen_hair/own.h\"\n", ":1:", "frozen" },
    { "engine/plan/program.c", "#include \"scene.h\"\n", ":1:", "outside engine/" },
    { "engine/attic/new.c", "#include \"wisp/base.h\"\n", ":1:", "order" },
    { "engine/include/wisp/bad.h", "#include \"store.h\"\n", ":1:", "public headers only" },
    { "engine/include/wisp/host.h", "#include \"wisp/module/module.h\"\n", ":1:", "not for hosts" },
    { "modules/frozen_hair/frozen_hair.h", "#include \"wisp/module/module.h\"\n", ":1:", "not for hosts" },
    { "examples/module.c", "#include <wisp/module/module.h>\n", ":1:", "not for hosts" },
    { "modules/frozen_hair/out.c", "#include \"store.h\"\n", ":1:", "own folder" },
    { "modules/strand_appearance/other.c", "#include \"frozen_hair.h\"\n", ":1:", "another module" },
    { "modules/strand_appearance/face.c", "#include <wisp/frozen_hair.h>\n", ":1:", "another module" },
    { "app/io/up.c", "#include \"main.c\"\n", ":1:", "above app/io" },
    { "app/io/bench.c", "#include \"bench.h\"\n", ":1:", "above app/io" },
    { "app/results/bench.c", "#include \"bench.h\"\n", ":1:", "above app/io" },
    { "app/own.c", "#include \"own.h\"\n#include \"frozen_hair/own.h\"\n", ":1:", "module's own" },
    { "app/engine.c", "#include \"store.h\"\n", ":1:", "only engine/include/wisp" },
    { "bench/up.c", "#include \"main.c\"\n", ":1:", "benchmark stands" },
    { "examples/inside.c", "#include \"alloc.h\"\n", ":1:", "only engine/include/wisp" },
    // unknown names, and forbidden dependencies of the library
    { "engine/plan/gone.c", "#include \"gone.h\"\n", ":1:", "gone.h" },
    { "app/gone.c", "#include \"gone.h\"\n", ":1:", "no file" },
    { "engine/plan/computed.c", "#include HEADER\n", ":1:", "computed" },
    { "modules/frozen_hair/parser.c", "int a;\n\n#include <yaml.h>\n", ":3:", "yaml.h" },
    { "engine/plan/embree.c", "#include <embree3/rtcore.h>\n", ":1:", "embree3" },
    // an effect in the engine
    { "engine/plan/a.c", "int frozen_count;\n", ":1:", "frozen" },
    { "engine/plan/b.c", "\n// WISP_COUNT_FROZEN is no word of the engine\n", ":2:", "frozen" },
    { "engine/plan/README.md", "Frozen things\n", ":1:", "frozen" },
    { "engine/plan/frozen.md", "", ":0:", "frozen" },
    { "engine/include/wisp/c.h", "float balloons;\n", ":1:", "balloon" },
    { "engine/store/d.c", "int strand_appearance;\n", ":1:", "strand_appearance" },
    { "engine/store/meson.build", "files('frozen.c')\n", ":1:", "frozen" },
    // OpenMP
    { "engine/plan/e.c", "#include <omp.h>\n", ":1:", "OpenMP" },
    { "engine/kernels/f.c", "#  pragma   omp simd\n", ":1:", "OpenMP" },
    { "modules/strand_appearance/g.c", "_Pragma( \"omp parallel\" )\n", ":1:", "OpenMP" },
    { "app/h.c", "int n = omp_get_max_threads();\n", ":1:", "OpenMP" },
    { "engine/world/meson.build", "lib(dependencies : openmp_dep)\n", ":1:", "OpenMP" },
    // intrinsics
    { "engine/plan/i.c", "#include <immintrin.h>\n", ":1:", "intrinsics" },
    { "engine/math/vec_fast.h", "__m128 a;\n", ":1:", "intrinsics" },
    { "modules/strand_appearance/j.c", "a = _mm256_add_ps( a, b );\n", ":1:", "intrinsics" },
    { "bench/k.c", "__mmask16 m;\n", ":1:", "intrinsics" },
    { "engine/space/l.c", "#include <simde/x86/avx2.h>\n", ":1:", "intrinsics" },
    { "engine/space/meson.build", "lib(c_args : ['-mavx512f'])\n", ":1:", "instruction set" },
    // meson files
    { "engine/math/meson.build", "lib(base_include, jobs_include)\n", ":1:", "jobs" },
    { "engine/cook/meson.build", "\nlib(include : [base_include,\n  store_lib])\n", ":3:", "store" },
    { "engine/base/meson.build", "lib(module_libs)\n", ":1:", "module" },
    { "modules/strand_appearance/meson.build", "lib(public_include, plan_include)\n", ":1:", "plan" },
    { "modules/strand_appearance/sub/meson.build", "include_directories('../../../engine/plan')\n",
      ":1:", "own folder" },
    { "app/meson.build", "executable(engine_includes)\n", ":1:", "engine" },
};

// ---- a small tree ----

static void write_file( const char* root, const planted* file )
{
    char path[PATH_MAX];
    snprintf( path, sizeof( path ), "%s/%s", root, file->path );
    for ( char* slash = strchr( path + strlen( root ) + 1, '/' ); slash; slash = strchr( slash + 1, '/' ) )
    {
        *slash = 0;
        mkdir( path, 0755 );
        *slash = '/';
    }
    FILE* out = fopen( path, "w" );
    assert_non_null( out );
    fputs( file->text, out );
    assert_int_equal( fclose( out ), 0 );
}

static int remove_one( const char* path, const struct stat* info, int kind, struct FTW* place )
{
    (void)info, (void)kind, (void)place;
    return remove( path );
}

static int make_clean_tree( void** state )
{
    char* root = strdup( "layers.XXXXXX" );
    assert_non_null( mkdtemp( root ) );
    for ( size_t i = 0; i < sizeof( clean_tree ) / sizeof( clean_tree[0] ); ++i )
    {
        write_file( root, &clean_tree[i] );
    }
    *state = root;
    return 0;
}

static int remove_tree( void** state )
{
    char* root = *state;
    int status = nftw( root, remove_one, 8, FTW_DEPTH | FTW_PHYS );
    free( root );
    return status;
}

/// @param text receives the printed report, for free()
static int check( const char* root, char** text )
{
    size_t size;
    FILE* out = open_memstream( text, &size );
    assert_non_null( out );
    int found = check_layers( root, out );
    fclose( out );
    return found;
}

// The report must be of exactly this file, this line and this word.
static bool is_report_of( const planted* wrong, const char* text )
{
    char start[160];
    snprintf( start, sizeof( start ), "%s%s", wrong->path, wrong->line );
    return strncmp( text, start, strlen( start ) ) == 0 && strstr( text + strlen( start ), wrong->word ) != NULL;
}

// ---- tests ----

static void every_file_of_the_tree_keeps_to_its_layer( void** state )
{
    (void)state;
    char* text;
    int found = check( tree_root, &text );
    if ( found != 0 )
    {
        print_error( "%s", text );
    }
    free( text );
    assert_int_equal( found, 0 );
}

static void a_tree_that_uses_every_allowed_dependency_is_clean( void** state )
{
    char* text;
    int found = check( *state, &text );
    if ( found != 0 )
    {
        print_error( "%s", text );
    }
    free( text );
    assert_int_equal( found, 0 );
}

static void each_planted_violation_is_found_with_file_and_line( void** state )
{
    const char* root = *state;
    for ( size_t i = 0; i < sizeof( violations ) / sizeof( violations[0] ); ++i )
    {
        char path[PATH_MAX], *text;
        snprintf( path, sizeof( path ), "%s/%s", root, violations[i].path );
        write_file( root, &violations[i] );
        int found = check( root, &text );
        bool is_right = found >= 1 && is_report_of( &violations[i], text );
        if ( !is_right )
        {
            print_error( "planted in %s: found %d\n%s", violations[i].path, found, text );
        }
        free( text );
        assert_true( is_right );
        assert_int_equal( remove( path ), 0 );

        // A file that was there before is needed again by later ones.
        for ( size_t k = 0; k < sizeof( clean_tree ) / sizeof( clean_tree[0] ); ++k )
        {
            if ( strcmp( clean_tree[k].path, violations[i].path ) == 0 )
            {
                write_file( root, &clean_tree[k] );
            }
        }
    }
}

static void two_violations_are_two_lines( void** state )
{
    const planted wrong = { "engine/base/two.c", "#include \"jobs.h\"\n__m128 x;\n", NULL, NULL };
    write_file( *state, &wrong );
    char* text;
    int found = check( *state, &text );
    const char* second = strchr( text, '\n' );
    bool has_second = second && strncmp( second + 1, "engine/base/two.c:2:", 20 ) == 0;
    free( text );
    assert_int_equal( found, 2 );
    assert_true( has_second );
}

static void a_new_effect_becomes_a_word_that_the_engine_must_not_know( void** state )
{
    const planted engine = { "engine/plan/s.c", "int snow_depth;\n", NULL, NULL };
    const planted effect = { "modules/wet_snow/wet_snow.c", "#include \"wisp/module/module.h\"\n", NULL, NULL };
    char* text;

    write_file( *state, &engine );
    int before = check( *state, &text );
    free( text );
    write_file( *state, &effect );
    int after = check( *state, &text );
    free( text );

    assert_int_equal( before, 0 );
    assert_int_equal( after, 1 );
}

static void a_tree_without_an_engine_is_refused( void** state )
{
    (void)state;
    char* text;
    int found = check( "no such folder", &text );
    bool says_so = strstr( text, "no engine" ) != NULL;
    free( text );
    assert_int_equal( found, -1 );
    assert_true( says_so );
}

int main( int argc, char** argv )
{
    if ( argc != 2 )
    {
        fprintf( stderr, "usage: %s ROOT-OF-THE-TREE\n", argv[0] );
        return 64;
    }
    tree_root = argv[1];
#define WITH_TREE( test ) cmocka_unit_test_setup_teardown( test, make_clean_tree, remove_tree )
    const struct CMUnitTest tests[] = {
        cmocka_unit_test( every_file_of_the_tree_keeps_to_its_layer ),
        WITH_TREE( a_tree_that_uses_every_allowed_dependency_is_clean ),
        WITH_TREE( each_planted_violation_is_found_with_file_and_line ),
        WITH_TREE( two_violations_are_two_lines ),
        WITH_TREE( a_new_effect_becomes_a_word_that_the_engine_must_not_know ),
        cmocka_unit_test( a_tree_without_an_engine_is_refused ),
    };
    return cmocka_run_group_tests( tests, NULL, NULL );
}
