/// Ranges and units that several tables share. Private to this room.
///
/// Ranges are those that the modules, the makers of grooms and meshes, and the engine accept: what a scene lets through,
/// they take.
#pragma once

#define RANGE( from, to )                                                                                            \
    {                                                                                                                \
        ( from ), ( to )                                                                                             \
    }
#define UNIT_RANGE RANGE( 0, 1 )
#define COORDINATE RANGE( -1e6, 1e6 )
#define SIZE RANGE( 1e-6, 1e6 )
#define TIME RANGE( 0, 1e6 )
#define COMPLIANCE RANGE( 0, 1e12 )
#define ANY_MASS RANGE( 1e-12, 1e12 )

// Vectors whose length is bounded: each part is at most the bound over the square root of three.
#define ACCELERATION RANGE( -5e5, 5e5 )
#define VELOCITY RANGE( -5e5, 5e5 )
#define WIND RANGE( -5e4, 5e4 )

// What is said to who writes a unit behind a number.
#define METRES "lengths are plain numbers in metres"
#define RADIANS "angles are plain numbers in radians"
#define DEGREES "these angles are plain numbers in degrees"
#define CELSIUS "temperatures are plain numbers in degrees Celsius"
#define KELVIN "temperatures of a gas are plain numbers in kelvin"
#define SECONDS "times are plain numbers in seconds"
#define SPEEDS "velocities are plain numbers in m/s"
#define TURNS "angular velocities are plain numbers in rad/s"
#define ACCELERATIONS "accelerations are plain numbers in m/s^2"
#define DENSITIES "area densities are plain numbers in kg/m^2"
#define LINE_DENSITIES "line densities are plain numbers in kg/m"
#define AIR_DENSITIES "densities are plain numbers in kg/m^3"
#define MASSES "masses are plain numbers in kg"
#define MOLAR_MASSES "molar masses are plain numbers in kg/mol"
#define PRESSURES "pressures are plain numbers in Pa"
#define AREAS "areas are plain numbers in m^2"
#define FLOWS "flows of gas are plain numbers in m^3/s"
#define RATES "rates are plain numbers in 1/s"
#define COMPLIANCES "compliances are plain numbers in m/N"
#define STIFFNESSES "stiffnesses are plain numbers in N/m"
#define RIGIDITIES "rigidities are plain numbers in N m"
#define LINK_DAMPINGS "dampings of a link are plain numbers in N s/m"
#define ROD_RIGIDITIES "rigidities of a rod are plain numbers in N m^2"
