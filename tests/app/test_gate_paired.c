// Statistics of the gate.
#include "unit.h"

#include "gate_paired.h"

#include <math.h>

TEST( the_exact_test_counts_sign_patterns )
{
    const double all[] = { 1.0, 2.0, 3.0, 4.0 };
    assert_true( gate_sign_flip( all, 4 ) == 1.0 / 16.0 ); // only one pattern has as large a sum
    const double mixed[] = { 1.0, -1.0 };
    assert_true( gate_sign_flip( mixed, 2 ) == 3.0 / 4.0 ); // +2, 0 and 0 of four
    const double below[] = { -1.0, -2.0, -3.0 };
    assert_true( gate_sign_flip( below, 3 ) == 1.0 );
}

// Under no difference a p of at most q comes up in at most q of all cases.
TEST( the_exact_test_holds_its_level )
{
    enum
    {
        TRIALS = 4000,
        COUNT = 10,
    };
    int alarms = 0;
    uint64_t random = 1;
    for ( int t = 0; t < TRIALS; ++t )
    {
        double values[COUNT];
        for ( int i = 0; i < COUNT; ++i )
        {
            random = random * 6364136223846793005u + 1442695040888963407u;
            const double u = (double)( random >> 11 ) / 9007199254740992.0 - 0.5;
            values[i] = u * fabs( u ); // symmetric, with long tails
        }
        alarms += gate_sign_flip( values, COUNT ) <= 0.05 ? 1 : 0;
    }
    assert_true( alarms > TRIALS * 0.03 && alarms < TRIALS * 0.065 );
}
