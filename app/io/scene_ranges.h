/// Ranges and units that several tables share. Private to this folder.
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
#define DT_FACTOR RANGE( 0.001, 1000 )
#define FROZEN_STIFFNESS RANGE( 1e-3, 1e12 )
#define ANY_MASS RANGE( 1e-12, 1e12 )

// Vectors whose length is bounded: each part is at most the bound over the square root of three.
#define ACCELERATION RANGE( -5e5, 5e5 )
#define VELOCITY RANGE( -5e5, 5e5 )
#define WIND RANGE( -5e4, 5e4 )

// Units.
#define METRES "m"
#define RADIANS "rad"
#define PER_RADIAN "1/rad"
#define DEGREES "degrees"
#define CELSIUS "degrees Celsius"
#define KELVIN "K"
#define SECONDS "s"
#define SPEEDS "m/s"
#define TURNS "rad/s"
#define ACCELERATIONS "m/s^2"
#define DENSITIES "kg/m^2"
#define LINE_DENSITIES "kg/m"
#define AIR_DENSITIES "kg/m^3"
#define MASSES "kg"
#define MOLAR_MASSES "kg/mol"
#define PRESSURES "Pa"
#define AREAS "m^2"
#define FLOWS "m^3/s"
#define RATES "1/s"
#define COMPLIANCES "m/N"
#define STIFFNESSES "N/m"
#define RIGIDITIES "N m"
#define LINK_DAMPINGS "N s/m"
#define ROD_RIGIDITIES "N m^2"

// What is said more than once.
#define SCENE_COLLIDES "{} where the scene has colliders, else false"
