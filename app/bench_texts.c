// The commands of the program wisp-bench in tables, which both programs have: `wisp` lists and completes them.
#include "bench_texts.h"

#include "results.h"

#define BENCH_CASE( name, purpose, function ) name,
static const char* const case_names[] = {
#include "../bench/cases.inc"
};
#undef BENCH_CASE

static const option_row bench_rows[] = {
    OPTION_TITLE( "Measurement:" ),
    { "list", BENCH_KEY_LIST, NULL, "Print the cases and what each measures", OPTION_ANY },
    { "quick", BENCH_KEY_QUICK, NULL, "Fewer samples and no large sizes: 20 s per case, not 90", OPTION_ANY },
    { "seconds", BENCH_KEY_SECONDS, "S", "Approximate time limit per case", OPTION_ANY },
    { "workers", BENCH_KEY_WORKERS, "N", "Workers of the parallel variant, 1 to 64, default 2", OPTION_ANY },
    OPTION_TITLE( "Output:" ),
    OPTION_RESULTS_FORMAT( BENCH_KEY_FORMAT ),
    { "output", BENCH_KEY_OUTPUT, "FILE", "Write the results to FILE; default: standard output",
      OPTION_FILES( "*" ) },
    { "report", BENCH_KEY_REPORT, "FILE", "Also write an HTML page with charts and pictures",
      OPTION_FILES( ".html" ) },
    OPTION_TITLE( "Options of single cases:" ),
    { "pictures", BENCH_KEY_PICTURES, "FOLDER", "figures, boundary, contact: write pictures to FOLDER",
      OPTION_FILES( "/" ) },
    { "scene", BENCH_KEY_SCENE, "NAME[,NAME...]", "accuracy: only these scenes; can be repeated", OPTION_ANY },
    { "long", BENCH_KEY_LONG, NULL, "stability, suites: also rows that are long, such as a million steps at rest",
      OPTION_ANY },
};

const command_text bench_text = {
    .name = "bench",
    .operands = "[CASE|SUITE...]",
    .noun = "CASE",
    .summary = "measure time and error together",
    .about = "Measure time, error and hash together. Without a CASE all cases run.\n"
             "A SUITE is a YAML file of scenes and settings: docs/suites.md has its format.",
    .notes = "A check fails if hashes differ between worker counts, if an error is above its\n"
             "tolerance, or if a hard case breaks. Its line begins with FAILED.",
    .examples = "wisp bench --list\n"
                "wisp bench cloth --quick --report cloth.html\n"
                "wisp bench suite.yaml",
    .unmet = "a check failed",
    .rows = bench_rows,
    .row_count = WISP_COUNT( bench_rows ),
    .values = { case_names, WISP_COUNT( case_names ), ".yaml" },
};

static const option_row accuracy_rows[] = {
    OPTION_TITLE( "Measurement:" ),
    { "length", BENCH_KEY_LENGTH, "S", "Seconds of motion that are compared; default: all of the scene, at most 1",
      OPTION_ANY },
    { "seconds", BENCH_KEY_SECONDS, "S", "Approximate time limit, without that of the converged run; default 30",
      OPTION_ANY },
    { "workers", BENCH_KEY_WORKERS, "N", "Workers of the parallel variant, 1 to 64, default 2", OPTION_ANY },
    { "quick", BENCH_KEY_QUICK, NULL, "Fewer settings and samples", OPTION_ANY },
    OPTION_TITLE( "Output:" ),
    OPTION_RESULTS_FORMAT( BENCH_KEY_FORMAT ),
    { "output", BENCH_KEY_OUTPUT, "FILE", "Write the results to FILE; default: standard output",
      OPTION_FILES( "*" ) },
    { "report", BENCH_KEY_REPORT, "FILE", "Also write an HTML page with charts", OPTION_FILES( ".html" ) },
    { "suite", BENCH_KEY_SUITE, "FILE",
      "Only write the suite that this would run, to be changed, run by 'wisp bench' and gated",
      OPTION_FILES( ".yaml" ) },
};

const command_text accuracy_text = {
    .name = "accuracy",
    .operands = "SCENE",
    .noun = "scene",
    .summary = "show what accuracy costs in a scene",
    .about = "Show what accuracy costs in a scene: error and time by substeps, iterations and solvers, the\n"
             "settings that no other beats, the fastest ones at equal error, the most accurate ones at equal\n"
             "time, and observed orders.",
    .notes = "Errors are distances to the same scene with so many substeps and iterations that it has\n"
             "converged. How far it has is printed; smaller errors are not resolved. That run is kept in\n"
             "$WISP_CACHE, or in ~/.cache/wisp, and is not made again. Only the first second of a scene is\n"
             "compared unless --length is given: motion becomes chaotic, and distances say nothing then.",
    .examples = "wisp accuracy scene.yaml\n"
                "wisp accuracy scene.yaml --length 0.5 --report accuracy.html\n"
                "wisp accuracy scene.yaml --suite suite.yaml",
    .unmet = "a check failed: two runs of one setting have other bits",
    .rows = accuracy_rows,
    .row_count = WISP_COUNT( accuracy_rows ),
    .values = OPTION_FILES( ".yaml .yml .json" ),
};
