// Limits to verdicts, independent of what is simulated: samples and limits are numbers.
#include "stability.h"

#include <math.h>

const char* const stability_limit_names[STABILITY_LIMIT_COUNT] = {
    "none", "finite", "halted", "strain", "recovery", "energy", "speed", "jitter", "breach", "claim", "bits",
};

// The larger one, and NaN if there is one, which fmax would ignore.
static double worse( double before, double now )
{
    return now <= before || isnan( before ) ? before : now;
}

static bool is_sound( const stability_observation* observation )
{
    return observation->is_finite && isfinite( observation->strain ) && isfinite( observation->speed );
}

static void watch_energy( stability_score* score, const stability_limits* limits, double energy )
{
    if ( score->frames <= limits->driven_frames )
    {
        score->energy_start = energy;
        score->energy_rise = 0.0;
    }
    score->energy_rise = worse( score->energy_rise, energy - score->energy_start );
}

void stability_watch( stability_score* score, const stability_limits* limits, int frame_count,
                      const stability_observation* observation )
{
    const bool is_first = score->frames == 0 && score->last.is_finite == false;
    score->frames += is_first ? 0 : 1;
    score->last = *observation;
    score->last.strain_limit = fmin( observation->strain_limit, limits->strain );
    if ( is_sound( observation ) == false && score->not_finite == 0 )
    {
        score->not_finite = score->frames > 0 ? score->frames : 1;
    }
    if ( observation->is_halted && score->halted == 0 )
    {
        score->halted = score->frames;
    }
    watch_energy( score, limits, observation->energy );
    score->strain_max = worse( score->strain_max, observation->strain );
    score->speed_max = worse( score->speed_max, observation->speed );
    if ( score->frames > limits->driven_frames )
    {
        score->breach_max = worse( score->breach_max, observation->breach );
    }
    if ( score->frames > 0 && !( observation->strain <= score->last.strain_limit ) )
    {
        score->beyond = score->frames;
    }
    if ( score->frames > frame_count - limits->still_frames )
    {
        score->jitter = worse( score->jitter, observation->speed );
    }
}

static stability_verdict broken( stability_limit limit, double measured, double allowed, int frames )
{
    return ( stability_verdict ){ limit, measured, allowed, frames };
}

stability_verdict stability_judge( const stability_score* score, const stability_limits* limits )
{
    const stability_observation* last = &score->last;
    const int late = score->beyond > limits->driven_frames ? score->beyond - limits->driven_frames : 0;
    if ( score->not_finite > 0 )
    {
        return broken( STABILITY_LIMIT_FINITE, score->not_finite, 0.0, 0 );
    }
    if ( score->halted > 0 )
    {
        // a halted body does not move: its other numbers mean nothing
        return broken( limits->may_halt ? STABILITY_LIMIT_NONE : STABILITY_LIMIT_HALTED, score->halted, 0.0, 0 );
    }
    if ( !( last->strain <= last->strain_limit ) )
    {
        return broken( STABILITY_LIMIT_STRAIN, last->strain, last->strain_limit, late );
    }
    if ( late > limits->recovery_frames )
    {
        return broken( STABILITY_LIMIT_RECOVERY, late, limits->recovery_frames, late );
    }
    if ( isinf( limits->energy ) == 0 && !( score->energy_rise <= limits->energy ) )
    {
        return broken( STABILITY_LIMIT_ENERGY, score->energy_rise, limits->energy, late );
    }
    if ( !( score->speed_max <= limits->speed ) )
    {
        return broken( STABILITY_LIMIT_SPEED, score->speed_max, limits->speed, late );
    }
    if ( !( score->jitter <= limits->jitter ) )
    {
        return broken( STABILITY_LIMIT_JITTER, score->jitter, limits->jitter, late );
    }
    if ( !( score->breach_max <= limits->breach ) )
    {
        return broken( STABILITY_LIMIT_BREACH, score->breach_max, limits->breach, late );
    }
    return ( stability_verdict ){ .frames = late };
}
