// The commands that measure, in tables.
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
    { "report", BENCH_KEY_REPORT, "FILE", "Also write an HTML page with charts", OPTION_FILES( ".html" ) },
    OPTION_TITLE( "Options of single cases:" ),
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
    { "shard", BENCH_KEY_SHARD, "K/N", "The share K of N, from 1/N to N/N; default: all", OPTION_ANY },
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
             "have the same bits. A part gets a line for each row, so a process that is killed loses the row\n"
             "that it ran. The same command goes on: rows that are there are not run again.",
    .examples = "wisp sweep suite.yaml -o results\n"
                "wisp sweep suite.yaml -o results --shard 2/8\n"
                "sbatch --array=1-8 --wrap 'wisp sweep s.yaml -o out --shard $SLURM_ARRAY_TASK_ID/8'",
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
             "two runs of a row have different bits. Errors come from any machine. Times come from runs with\n"
             "--exclusive alone; where they are of several processors, a column names these.",
    .examples = "wisp merge results\n"
                "wisp merge results --report sweep.html --format csv -o sweep.csv",
    .unmet = "a row could not be run, or breaks a check that it should not",
    .rows = merge_rows,
    .row_count = WISP_COUNT( merge_rows ),
    .values = OPTION_FILES( "/" ),
};

static const char* const action_words[] = { "record", "check", "accept", "step", "self-test" };

static const option_row gate_rows[] = {
    OPTION_TITLE( "Files:" ),
    { "base", 'b', "FILE", "The base file, default SUITE-base.json beside the suite", OPTION_FILES( ".json" ) },
    { "output", 'o', "FILE", "The results; record, accept: the base file, as --base", OPTION_FILES( ".json" ) },
    OPTION_TITLE( "Measuring:" ),
    { "no-instructions", GATE_KEY_NO_INSTRUCTIONS, NULL, "Do not count instructions, for which valgrind is needed",
      OPTION_ANY },
    { "cycles", GATE_KEY_CYCLES, NULL,
      "record, accept: estimate cycles too, with a model of caches; three times as slow", OPTION_ANY },
    { "isa", GATE_KEY_ISA, "SET", "Kernels: baseline, avx2 or avx512; default: the best, whose bits are the same",
      OPTION_WORDS( option_isa_words ) },
    { "steps", GATE_KEY_STEPS, "N", "Measure the first N steps of each row", OPTION_ANY },
    { "row", GATE_KEY_ROW, "N", "step, self-test: number of the row, counted from 0", OPTION_ANY },
    { "turns", GATE_KEY_TURNS, NULL, NULL, OPTION_ANY },
    { "slow", GATE_KEY_SLOW, "N", NULL, OPTION_ANY },
    { "trials", GATE_KEY_TRIALS, "N", "self-test: gates of each slow-down, default 10", OPTION_ANY },
    { "paired", GATE_KEY_PAIRED, "WISP", "check: compare times with another program, instead of a base file",
      OPTION_FILES( "*" ) },
    { "patience", GATE_KEY_PATIENCE, "S", "check --paired: longest time of one run of a row, default 120 s",
      OPTION_ANY },
    OPTION_TITLE( "Verdict:" ),
    { "reason", 'r', "TEXT", "accept: why the new values are right; it is kept in the base file", OPTION_ANY },
    { "patch", GATE_KEY_PATCH, "FILE", "accept: leave the base file, and write a patch for 'git apply'",
      OPTION_FILES( "*" ) },
    { "strict", GATE_KEY_STRICT, NULL, "check: rows that only the suite or only the base has fail, too", OPTION_ANY },
    OPTION_TITLE( "Output:" ),
    { "format",
      'f',
      "FORMAT",
      "text (default), markdown, csv, json or latex",
      { results_format_names, RESULTS_FORMAT_COUNT, NULL } },
    { "junit", GATE_KEY_JUNIT, "FILE", "Write JUnit's XML too, a test case for each row", OPTION_FILES( ".xml" ) },
    { "html", GATE_KEY_HTML, "FILE", "Write one HTML page too, with charts of before and after",
      OPTION_FILES( ".html" ) },
    { "github", GATE_KEY_GITHUB, NULL, "Tell GitHub: annotations, and the table in the summary of the step",
      OPTION_ANY },
};

const command_text gate_text = {
    .name = "gate",
    .operands = "ACTION SUITE",
    .noun = "action",
    .summary = "measure the scenes of a suite, and fail if one became worse",
    .about = "Measure the scenes of a suite and fail if one became worse.",
    .notes = "Actions:\n"
             "  record SUITE     measure all rows and write the base file\n"
             "  check SUITE      measure all rows and compare them with the base file\n"
             "  accept SUITE     the same as record, with a reason, which the base file keeps\n"
             "  self-test SUITE  compare times of this program with itself, slowed down: what is found?\n"
             "  step SUITE       only run the steps of one row, for profilers\n"
             "\n"
             "What is compared is the same in every run: bits of all points, instructions, bytes,\n"
             "allocations, stretch, energy, penetration, intersections, resets. docs/gate.md has the format\n"
             "of suites and of budgets.",
    .examples = "wisp gate record suite.yaml -o base.json\n"
                "wisp gate check suite.yaml --base base.json --junit gate.xml\n"
                "wisp gate check suite.yaml --paired ../old/build/app/wisp",
    .unmet = "a row is worse than its budget allows",
    .rows = gate_rows,
    .row_count = WISP_COUNT( gate_rows ),
    .values = { action_words, WISP_COUNT( action_words ), ".yaml" },
};

static const char* const twin_words[] = { "all", "bits", "snapshot", "scale", "shift" };
static const option_row torture_rows[] = {
    OPTION_TITLE( "Judgement:" ),
    { "limit", TORTURE_KEY_LIMIT, "SECONDS", "Wall time of a scene, default 20", OPTION_ANY },
    { "twin", TORTURE_KEY_TWIN, "TWIN", "Run it again in this way alone, default all", OPTION_WORDS( twin_words ) },
    { "close", TORTURE_KEY_CLOSE, NULL, "Judge by the close limits of suites with checks, too", OPTION_ANY },
    OPTION_TITLE( "Output:" ),
    OPTION_RESULTS_FORMAT( TORTURE_KEY_FORMAT ),
};

const command_text torture_text = {
    .name = "torture",
    .operands = "SCENE...",
    .noun = "scene",
    .summary = "judge whether the engine withstands scenes",
    .about = "Judge whether the engine withstands scenes.",
    .notes = "Each scene runs in a process of its own, and again in other ways, and is judged: crash,\n"
             "time, status, finite, halted, energy, strain, penetration, intersections, rest, bits,\n"
             "snapshot, scale, shift. docs/outputs.md explains each.",
    .examples = "wisp torture --close data/scenes/flag.yaml",
    .unmet = "a scene breaks",
    .rows = torture_rows,
    .row_count = WISP_COUNT( torture_rows ),
    .values = OPTION_FILES( ".yaml .yml .json" ),
};
