// The commands of the program wisp-bench in tables, which both programs have: `wisp` lists and completes them.
#include "bench_texts.h"

#include "results.h"

#define BENCH_CASE( name, purpose, function ) name,
static const char* const case_names[] = {
#include "../bench/cases.inc"
};
#undef BENCH_CASE

// Rows that several commands have.
#define WORKERS_ROW                                                                                                  \
    {                                                                                                                \
        "workers", BENCH_KEY_WORKERS, "N", "Workers of the parallel variant, 1 to 64, default 2", OPTION_ANY         \
    }
#define OUTPUT_ROWS                                                                                                  \
    OPTION_RESULTS_FORMAT( BENCH_KEY_FORMAT ),                                                                       \
    {                                                                                                                \
        "output", BENCH_KEY_OUTPUT, "FILE", "Write the results to FILE; default: standard output",                   \
            OPTION_FILES( "*" )                                                                                      \
    }
#define REPORT_ROW                                                                                                   \
    {                                                                                                                \
        "report", BENCH_KEY_REPORT, "FILE", "Also write an HTML page with charts", OPTION_FILES( ".html" )           \
    }

static const option_row bench_rows[] = {
    OPTION_TITLE( "Measurement:" ),
    { "list", BENCH_KEY_LIST, NULL, "Print the cases and what each measures", OPTION_ANY },
    { "quick", BENCH_KEY_QUICK, NULL, "Fewer samples and no large sizes: 20 s per case, not 90", OPTION_ANY },
    { "seconds", BENCH_KEY_SECONDS, "S", "Approximate time limit per case", OPTION_ANY },
    WORKERS_ROW,
    OPTION_TITLE( "Output:" ),
    OUTPUT_ROWS,
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
    WORKERS_ROW,
    { "quick", BENCH_KEY_QUICK, NULL, "Fewer settings and samples", OPTION_ANY },
    OPTION_TITLE( "Output:" ),
    OUTPUT_ROWS,
    REPORT_ROW,
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

static const option_row validate_rows[] = {
    OPTION_TITLE( "Measurement:" ),
    { "list", BENCH_KEY_LIST, NULL, "Print the cases", OPTION_ANY },
    { "quick", BENCH_KEY_QUICK, NULL, "Fewer settings and samples", OPTION_ANY },
    { "seconds", BENCH_KEY_SECONDS, "S", "Approximate time limit per case, default 20", OPTION_ANY },
    WORKERS_ROW,
    OPTION_TITLE( "Output:" ),
    OUTPUT_ROWS,
    REPORT_ROW,
};

const command_text validate_text = {
    .name = "validate",
    .operands = "[CASE...]",
    .noun = "CASE",
    .summary = "measure errors against theory, beside time",
    .about = "Measure errors against theory beside the time of a step, by every solver that can do a case: with\n"
             "which settings they converge, and to what. Without a CASE all cases run.",
    .notes = "Each case says what it tests, what it leaves out, its formula and its source. Errors are shown,\n"
             "whatever they are: docs/validation.md tells which are large, and why.",
    .examples = "wisp validate --report validation.html\n"
                "wisp validate cantilever column --quick",
    .unmet = "two runs of one setting have other bits",
    .rows = validate_rows,
    .row_count = WISP_COUNT( validate_rows ),
    .values = OPTION_ANY,
};

static const option_row sweep_rows[] = {
    OPTION_TITLE( "What is run:" ),
    { "output", BENCH_KEY_OUTPUT, "FOLDER", "Folder of the parts, made if it is not there; required",
      OPTION_FILES( "/" ) },
    { "shard", BENCH_KEY_SHARD, "I/N",
      "The share I of N, from 1/N to N/N; default: what the scheduler says, else all", OPTION_ANY },
    { "shards", BENCH_KEY_SHARDS, "N", "N shares, where the scheduler says only which one this is, from 1 on",
      OPTION_ANY },
    { "resume", BENCH_KEY_RESUME, NULL, "Go on with a part that was begun, and accept one that is done", OPTION_ANY },
    { "list", BENCH_KEY_LIST, NULL, "Print the numbers, hashes and names of the items, and run none", OPTION_ANY },
    OPTION_TITLE( "Times:" ),
    { "exclusive", BENCH_KEY_EXCLUSIVE, NULL, "Nothing else runs on this machine: measure times too", OPTION_ANY },
    { "workers", BENCH_KEY_WORKERS, "N", "Time with one worker and with N, 1 to 64, default 1", OPTION_ANY },
};

const command_text sweep_text = {
    .name = "sweep",
    .operands = "SUITE",
    .noun = "suite",
    .summary = "run a suite in shares, on one or many machines",
    .about = "Run the rows of a suite, or a share of them, and keep the errors, hashes and measures of each in a\n"
             "part file. 'wisp merge' makes one result of all parts. docs/scaling.md shows how clusters run it.",
    .notes = "Rows go to shares by the hash of their settings; one in a hundred is run by two of them, and must\n"
             "have the same bits. A part has a line for each row that was run, so a process that is killed\n"
             "loses the row that it ran; --resume goes on. Without --shard the share is that of a Slurm array\n"
             "(SLURM_ARRAY_TASK_ID), of GTEST_SHARD_INDEX, of a PBS array (PBS_ARRAY_INDEX, with --shards), or of\n"
             "a job of HTCondor.",
    .examples = "wisp sweep suite.yaml -o results\n"
                "wisp sweep suite.yaml -o results --shard 2/8 --resume\n"
                "sbatch --array=1-8 --requeue --wrap 'wisp sweep suite.yaml -o results --resume'",
    .unmet = "a row could not be run, or breaks a check that it should not",
    .rows = sweep_rows,
    .row_count = WISP_COUNT( sweep_rows ),
    .values = OPTION_FILES( ".yaml .yml .json" ),
};

static const option_row merge_rows[] = {
    OUTPUT_ROWS,
    REPORT_ROW,
};

const command_text merge_text = {
    .name = "merge",
    .operands = "FOLDER",
    .noun = "folder",
    .summary = "make one result of the parts of a sweep",
    .about = "Make one result of the parts that 'wisp sweep' has written to a folder.",
    .notes = "Nothing is merged if a part or a row is missing, if parts are of different suites or versions, or if\n"
             "two runs of a row have different bits. Errors come from any machine. Times come from parts with\n"
             "--exclusive alone, and those of different processors are in columns of their own.",
    .examples = "wisp merge results\n"
                "wisp merge results --report sweep.html --format csv -o sweep.csv",
    .unmet = "a row could not be run, or breaks a check that it should not",
    .rows = merge_rows,
    .row_count = WISP_COUNT( merge_rows ),
    .values = OPTION_FILES( "/" ),
};
