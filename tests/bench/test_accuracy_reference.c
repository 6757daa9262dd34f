// Stored references of `wisp bench accuracy`: untrusted files, and whether those of data/reference are valid.
#include "unit.h"

#include "accuracy/accuracy_reference.h"
#include "reference_bytes.h"

enum
{
    NUMBERS = 7,
    FILE_SIZE = 8 + 8 + 8 * NUMBERS + 8,
    LONGEST = 8192,
};

static const char generator_name[] = "pretended.json";
static const char numbers_name[] = "pretended.reference";

/// Both files, as they were written.
typedef struct reference_files
{
    char generator[LONGEST];
    unsigned char numbers[FILE_SIZE];
    size_t generator_size, numbers_size;
    uint64_t hash;
} reference_files;

static accuracy_reference small_reference( double* numbers )
{
    accuracy_reference reference = { .scene = "pretended",
                                     .reference = "the number of the number",
                                     .solver = "counting",
                                     .precision = "double",
                                     .substeps = 640,
                                     .converged = "always",
                                     .uncertainty = 1.5e-4,
                                     .layout = "float64 [7]",
                                     .numbers = numbers,
                                     .number_count = NUMBERS };
    accuracy_reference_put( &reference, "width, m", 1.6 );
    accuracy_reference_put( &reference, "observations", 6.0 );
    for ( int i = 0; i < NUMBERS; ++i )
    {
        numbers[i] = 0.1 * i - 0.3;
    }
    return reference;
}

static size_t read_file( const char* name, void* to, size_t room )
{
    FILE* file = fopen( name, "rb" );
    assert_non_null( file );
    const size_t size = fread( to, 1, room, file );
    fclose( file );
    return size;
}

static void write_file( const char* name, const void* bytes, size_t size )
{
    wisp_error error = { 0 };
    assert_ok( reference_write_bytes( name, bytes, size, &error ), error );
}

static reference_files written( const accuracy_reference* reference )
{
    reference_files files = { .hash = 0 };
    wisp_error error = { 0 };
    assert_ok( accuracy_reference_write( reference, ".", &error ), error );
    files.generator_size = read_file( generator_name, files.generator, LONGEST - 1 );
    files.numbers_size = read_file( numbers_name, files.numbers, FILE_SIZE );
    files.hash = reference_checksum( files.numbers, FILE_SIZE - 8 );
    assert_int_equal( remove( generator_name ), 0 );
    assert_int_equal( remove( numbers_name ), 0 );
    return files;
}

static void expect_said( const wisp_error* error, const char* name, const char* part )
{
    assert_ptr_equal( strstr( error->message, name ), error->message );
    assert_contains( error->message, part );
}

// Blocks of exactly this size, so that the sanitizer detects a byte that is read beyond them.
static void expect_numbers_refused( const unsigned char* bytes, size_t size, uint64_t hash, const char* part )
{
    unsigned char* copy = malloc( size > 0 ? size : 1 );
    double* numbers;
    wisp_error error = { 0 };
    assert_non_null( copy );
    memcpy( copy, bytes, size );
    assert_int_equal(
        accuracy_reference_parse_numbers( copy, size, "given.reference", NUMBERS, hash, &numbers, &error ),
        WISP_BAD_INPUT );
    assert_null( numbers );
    expect_said( &error, "given.reference:", part );
    free( copy );
}

static void expect_generator_refused( const char* text, size_t size, const char* part )
{
    char* copy = malloc( size > 0 ? size : 1 );
    accuracy_reference reference;
    uint64_t hash;
    wisp_error error = { 0 };
    assert_non_null( copy );
    memcpy( copy, text, size );
    assert_int_equal( accuracy_reference_parse_generator( copy, size, "given.json", &reference, &hash, &error ),
                      WISP_BAD_INPUT );
    assert_int_equal( reference.fact_count, 0 );
    expect_said( &error, "given.json:", part );
    free( copy );
}

// ---- a pair of files ----

static void a_reference_comes_back_as_it_was_written( void** state )
{
    (void)state;
    double numbers[NUMBERS];
    const accuracy_reference reference = small_reference( numbers );
    accuracy_reference back;
    wisp_error error = { 0 };
    assert_ok( accuracy_reference_write( &reference, ".", &error ), error );
    assert_ok( accuracy_reference_read( ".", &reference, &back, &error ), error );
    remove( generator_name );
    remove( numbers_name );
    assert_string_equal( back.scene, reference.scene );
    assert_string_equal( back.reference, reference.reference );
    assert_string_equal( back.solver, reference.solver );
    assert_string_equal( back.precision, reference.precision );
    assert_string_equal( back.converged, reference.converged );
    assert_string_equal( back.layout, reference.layout );
    assert_int_equal( back.substeps, 640 );
    assert_true( back.uncertainty == reference.uncertainty );
    assert_int_equal( back.fact_count, 2 );
    assert_string_equal( back.info[1].name, "observations" );
    assert_true( back.info[1].value == 6.0 );
    assert_memory_equal( back.numbers, numbers, sizeof( numbers ) );
    accuracy_reference_free( &back );
}

static void a_reference_that_is_not_there_is_a_message( void** state )
{
    (void)state;
    double numbers[NUMBERS];
    const accuracy_reference reference = small_reference( numbers );
    accuracy_reference back;
    wisp_error error = { 0 };
    assert_int_equal( accuracy_reference_read( "no_such_folder", &reference, &back, &error ), WISP_IO_ERROR );
    expect_said( &error, "no_such_folder/pretended.json: ", "No such file" );

    // a recipe alone is no reference
    assert_ok( accuracy_reference_write( &reference, ".", &error ), error );
    remove( numbers_name );
    assert_int_equal( accuracy_reference_read( ".", &reference, &back, &error ), WISP_IO_ERROR );
    expect_said( &error, "./pretended.reference: ", "No such file" );
    assert_null( back.numbers );
    assert_int_equal( back.fact_count, 0 );
    remove( generator_name );
}

static void numbers_of_another_generator_are_refused( void** state )
{
    (void)state;
    double numbers[NUMBERS];
    const accuracy_reference reference = small_reference( numbers );
    const reference_files before = written( &reference );
    numbers[3] += 1e-9;
    const reference_files after = written( &reference );
    accuracy_reference back;
    wisp_error error = { 0 };
    write_file( generator_name, before.generator, before.generator_size );
    write_file( numbers_name, after.numbers, after.numbers_size );
    assert_int_equal( accuracy_reference_read( ".", &reference, &back, &error ), WISP_BAD_INPUT );
    expect_said( &error, "./pretended.reference: ", "its recipe has" );
    remove( generator_name );
    remove( numbers_name );
}

static void a_file_that_is_too_long_is_not_read_to_its_end( void** state )
{
    (void)state;
    double numbers[NUMBERS];
    const accuracy_reference reference = small_reference( numbers );
    const reference_files files = written( &reference );
    const size_t size = ACCURACY_REFERENCE_GENERATOR_MAX + 100000;
    char* longer = malloc( size );
    accuracy_reference back;
    wisp_error error = { 0 };
    assert_non_null( longer );
    memset( longer, ' ', size );
    memcpy( longer, files.generator, files.generator_size );
    write_file( generator_name, longer, size );
    assert_int_equal( accuracy_reference_read( ".", &reference, &back, &error ), WISP_BAD_INPUT );
    expect_said( &error, "./pretended.json: ", "longer than the 65536 bytes" );

    memcpy( longer, files.numbers, files.numbers_size );
    write_file( generator_name, files.generator, files.generator_size );
    write_file( numbers_name, longer, size );
    assert_int_equal( accuracy_reference_read( ".", &reference, &back, &error ), WISP_BAD_INPUT );
    // one more byte than expected was read, whatever follows
    expect_said( &error, "./pretended.reference: ", "7 numbers in 81 bytes" );
    remove( generator_name );
    remove( numbers_name );
    free( longer );
}

static void a_reference_of_a_scene_that_has_changed_is_refused_by_what_changed( void** state )
{
    (void)state;
    double numbers[NUMBERS];
    const accuracy_reference reference = small_reference( numbers );
    accuracy_reference back, requested = reference;
    wisp_error error = { 0 };
    assert_ok( accuracy_reference_write( &reference, ".", &error ), error );
    requested.info[0].value = 1.61;
    assert_int_equal( accuracy_reference_read( ".", &requested, &back, &error ), WISP_BAD_INPUT );
    expect_said( &error, "./pretended.json: ", "`width, m` is 1.6, but 1.61 in the scene; `./dev reference --scene" );
    requested = reference;
    accuracy_reference_put( &requested, "wind, m/s", 4.0 );
    assert_int_equal( accuracy_reference_read( ".", &requested, &back, &error ), WISP_BAD_INPUT );
    expect_said( &error, "./pretended.json: ", "there is no fact `wind, m/s`" );
    requested = reference;
    requested.number_count = NUMBERS + 1;
    assert_int_equal( accuracy_reference_read( ".", &requested, &back, &error ), WISP_BAD_INPUT );
    expect_said( &error, "./pretended.json: ", "it has 7 numbers, the scene 8" );
    remove( generator_name );
    remove( numbers_name );
}

// Rounding does not make another mesh, and a vertex moved by a tenth of a millimetre does.
static void another_start_is_seen_and_its_roundings_are_not( void** state )
{
    (void)state;
    wisp_vec3 points[40];
    for ( int i = 0; i < WISP_COUNT( points ); ++i )
    {
        points[i] = ( wisp_vec3 ){ 0.1f * (float)i, 1.0f, -0.05f * (float)i };
    }
    double numbers[NUMBERS];
    accuracy_reference reference = small_reference( numbers ), requested = reference, back;
    wisp_error error = { 0 };
    accuracy_reference_put_start( &reference, points, WISP_COUNT( points ) );
    assert_ok( accuracy_reference_write( &reference, ".", &error ), error );
    points[17].x = nextafterf( points[17].x, 2.0f );
    accuracy_reference_put_start( &requested, points, WISP_COUNT( points ) );
    assert_ok( accuracy_reference_read( ".", &requested, &back, &error ), error );
    accuracy_reference_free( &back );
    points[17].x += 1e-4f;
    --requested.fact_count;
    accuracy_reference_put_start( &requested, points, WISP_COUNT( points ) );
    assert_int_equal( accuracy_reference_read( ".", &requested, &back, &error ), WISP_BAD_INPUT );
    expect_said( &error, "./pretended.json: ", "`weighted mean of the start, m`" );
    remove( generator_name );
    remove( numbers_name );
}

// ---- broken bytes ----

static void numbers_that_are_cut_off_anywhere_are_refused( void** state )
{
    (void)state;
    double numbers[NUMBERS];
    const accuracy_reference reference = small_reference( numbers );
    const reference_files files = written( &reference );
    assert_int_equal( files.numbers_size, FILE_SIZE );
    for ( size_t size = 0; size < FILE_SIZE; ++size )
    {
        expect_numbers_refused( files.numbers, size, files.hash, size < 24 ? "are too few" : "which take 80" );
    }
}

static void numbers_with_a_wrong_byte_are_refused_wherever_it_is( void** state )
{
    (void)state;
    double numbers[NUMBERS];
    const accuracy_reference reference = small_reference( numbers );
    reference_files files = written( &reference );
    for ( size_t at = 0; at < FILE_SIZE; ++at )
    {
        const char* part = at < 8    ? "this is no reference file"
                           : at < 12 ? "is not known"
                           : at < 16 ? "its recipe has 7 numbers"
                                     : "checksum";
        files.numbers[at] ^= 1u;
        expect_numbers_refused( files.numbers, FILE_SIZE, files.hash, part );
        files.numbers[at] ^= 1u;
    }
    expect_numbers_refused( files.numbers, FILE_SIZE, files.hash ^ 1u, "its recipe has" );
}

static void numbers_that_nothing_has_are_refused_by_their_place( void** state )
{
    (void)state;
    static const double wrong[] = { NAN, INFINITY, -INFINITY, 1e6, -1e300 };
    for ( int i = 0; i < WISP_COUNT( wrong ); ++i )
    {
        double numbers[NUMBERS];
        const accuracy_reference reference = small_reference( numbers );
        numbers[i] = wrong[i];
        const reference_files files = written( &reference );
        char part[40];
        snprintf( part, sizeof( part ), "number %d is out of range", i );
        expect_numbers_refused( files.numbers, FILE_SIZE, files.hash, part );
    }
}

static void a_generator_that_is_cut_off_anywhere_is_refused( void** state )
{
    (void)state;
    double numbers[NUMBERS];
    const accuracy_reference reference = small_reference( numbers );
    const reference_files files = written( &reference );
    // the last byte ends the line and has no content
    for ( size_t size = 0; size + 1 < files.generator_size; ++size )
    {
        expect_generator_refused( files.generator, size, "" );
    }
}

// Any byte of a recipe may change: the recipe is then rejected or has another meaning, and nothing worse happens.
static void a_generator_with_a_wrong_byte_does_no_harm( void** state )
{
    (void)state;
    double numbers[NUMBERS];
    const accuracy_reference reference = small_reference( numbers );
    reference_files files = written( &reference );
    int refused = 0;
    for ( size_t at = 0; at < files.generator_size; ++at )
    {
        for ( int bit = 0; bit < 8; ++bit )
        {
            accuracy_reference back;
            uint64_t hash;
            wisp_error error = { 0 };
            files.generator[at] = (char)( files.generator[at] ^ ( 1 << bit ) );
            const wisp_status status = accuracy_reference_parse_generator( files.generator, files.generator_size,
                                                                           "given.json", &back, &hash, &error );
            files.generator[at] = (char)( files.generator[at] ^ ( 1 << bit ) );
            assert_true( status == WISP_OK || status == WISP_BAD_INPUT );
            assert_true( ( status == WISP_OK ) == ( error.message[0] == '\0' ) );
            refused += status == WISP_BAD_INPUT;
        }
    }
    assert_true( refused > (int)files.generator_size );
}

// The first occurrence of a part, replaced.
static void expect_change_refused( const reference_files* files, const char* part, const char* by, const char* said )
{
    char text[2 * LONGEST];
    const char* at = strstr( files->generator, part );
    assert_non_null( at );
    const int size = snprintf( text, sizeof( text ), "%.*s%s%s", (int)( at - files->generator ), files->generator, by,
                               at + strlen( part ) );
    expect_generator_refused( text, (size_t)size, said );
}

static void a_generator_that_says_what_none_can_is_refused_by_the_word( void** state )
{
    (void)state;
    static const struct
    {
        const char *part, *by, *said;
    } wrong[] = {
        { "\"wisp_reference\": 2", "\"wisp_reference\": 3",
          "version 3, expected 2; `./dev reference` writes it again" },
        { "\"wisp_reference\": 2", "\"wisp_references\": 2", "`wisp_reference` must be a number" },
        { "\"scene\": \"pretended\"", "\"scene\": 7", "`scene` must be a text of 1 to 31 printable characters" },
        { "\"pretended\"", "\"\"", "`scene` must be" },
        { "\"pretended\"", "\"a scene whose name is much too long for it\"", "`scene` must be" },
        { "counting", "count\\ning", "`solver` must be a text" },
        { "\"double\"", "\"half\"", "`precision` is \"half\"" },
        { "640", "0", "`substeps` must be a number from 1" },
        { "640", "\"640\"", "`substeps` must be a number" },
        { "\"numbers\": 7", "\"numbers\": 1048577", "`numbers` must be a number from 1" },
        { "\"numbers\": 7", "\"numbers\": -7", "`numbers` must be a number from 1" },
        { "\"uncertainty_m\": ", "\"uncertainty_m\": -", "`uncertainty_m` must be" },
        { "\"width, m\": ", "\"width, m\": null, \"x\": ", "fact 1 is no number" },
        { "\"width, m\"", "\"a fact whose name is much longer than any fact has\"", "fact 1 is no number" },
        { "\"facts\": {", "\"facts\": [], \"others\": {", "`facts` must be an object" },
        { "\"hash\": \"", "\"hash\": \"x", "`hash` must be a text of 16 hexadecimal digits" },
        { "\"hash\"", "\"scene\"", "duplicate object key" },
    };
    double numbers[NUMBERS];
    const accuracy_reference reference = small_reference( numbers );
    const reference_files files = written( &reference );
    for ( int i = 0; i < WISP_COUNT( wrong ); ++i )
    {
        expect_change_refused( &files, wrong[i].part, wrong[i].by, wrong[i].said );
    }
}

static void more_info_than_there_is_room_for_are_refused( void** state )
{
    (void)state;
    double numbers[NUMBERS];
    const accuracy_reference reference = small_reference( numbers );
    const reference_files files = written( &reference );
    char many[2048] = "\"facts\": {";
    for ( int i = 0; i < ACCURACY_INFO_MAX - 1; ++i )
    {
        const size_t used = strlen( many );
        snprintf( many + used, sizeof( many ) - used, "\"fact %d\": %d, ", i, i );
    }
    expect_change_refused( &files, "\"facts\": {", many, "`facts` must be an object of at most 24 numbers" );
}

// ---- stored references ----

static void every_stored_reference_is_whole_and_small( void** state )
{
    (void)state;
    static const char* const names[] = { "balloon_flight", "balloon_meshes" };
    for ( int i = 0; i < WISP_COUNT( names ); ++i )
    {
        char path[1024], text[LONGEST];
        accuracy_reference generator, whole;
        uint64_t hash;
        wisp_error error = { 0 };
        snprintf( path, sizeof( path ), "%s/%s.json", accuracy_reference_folder(), names[i] );
        const size_t size = read_file( path, text, sizeof( text ) );
        assert_ok( accuracy_reference_parse_generator( text, size, path, &generator, &hash, &error ), error );
        assert_ok( accuracy_reference_read( accuracy_reference_folder(), &generator, &whole, &error ), error );
        print_message( "           %s: %d numbers, uncertainty %.3g mm, %s\n", names[i], whole.number_count,
                       1e3 * whole.uncertainty, whole.reference );
        assert_string_equal( whole.scene, names[i] );
        // a fine skin oscillates in short substeps, so this one alone is computed by the engine, and states it
        assert_string_equal( whole.precision, strcmp( names[i], "balloon_meshes" ) == 0 ? "float" : "double" );
        assert_true( whole.fact_count > 3 && whole.uncertainty > 0.0 );
        // they are in the tree
        assert_true( 8 * whole.number_count < 300000 );
        accuracy_reference_free( &whole );
    }
}

int main( void )
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test( a_reference_comes_back_as_it_was_written ),
        cmocka_unit_test( a_reference_that_is_not_there_is_a_message ),
        cmocka_unit_test( numbers_of_another_generator_are_refused ),
        cmocka_unit_test( a_file_that_is_too_long_is_not_read_to_its_end ),
        cmocka_unit_test( a_reference_of_a_scene_that_has_changed_is_refused_by_what_changed ),
        cmocka_unit_test( another_start_is_seen_and_its_roundings_are_not ),
        cmocka_unit_test( numbers_that_are_cut_off_anywhere_are_refused ),
        cmocka_unit_test( numbers_with_a_wrong_byte_are_refused_wherever_it_is ),
        cmocka_unit_test( numbers_that_nothing_has_are_refused_by_their_place ),
        cmocka_unit_test( a_generator_that_is_cut_off_anywhere_is_refused ),
        cmocka_unit_test( a_generator_with_a_wrong_byte_does_no_harm ),
        cmocka_unit_test( a_generator_that_says_what_none_can_is_refused_by_the_word ),
        cmocka_unit_test( more_info_than_there_is_room_for_are_refused ),
        cmocka_unit_test( every_stored_reference_is_whole_and_small ),
    };
    return cmocka_run_group_tests_name( "bench accuracy reference", tests, NULL, NULL );
}
