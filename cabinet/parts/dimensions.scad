// What all parts share. Millimetres and degrees. Change a value here or on the command line
// (openscad -D rod_diameter=15.9), and every part follows.

rod_diameter = 16;        // of the rod as measured [mm]
rod_clearance = 0.30;     // bore minus rod; print one bearing, try it, then change this [mm]
lens_distance = 2.4;      // lens's lower face to the rod's surface: PMW3360 2.2 to 2.6, mice the same [mm]

barrel_diameter = 34;     // of the bearing's barrel, which the sensor mount grips [mm]
barrel_length = 30;       // beyond the flange, along the rod [mm]
flange_width = 56;        // square, against the wall [mm]
flange_thickness = 6;     // [mm]
flange_hole = 4.5;        // wood screws of 4 mm [mm]
flange_hole_pitch = 42;   // [mm]

clamp_width = 14;         // of the ring on the barrel [mm]
clamp_wall = 5;           // [mm]
clamp_slit = 3;           // closes when the screw is tightened [mm]
screw = 3.3;              // clearance hole of M3 [mm]
nut_width = 5.7;          // M3 nut across flats, with clearance [mm]
nut_depth = 2.6;          // [mm]

arm_thickness = 5;        // [mm]
arm_gap = 0.25;           // between arm and plate, each side [mm]
height_range = 3;         // the plate moves up and down by this, each way [mm]

collar_width = 18;        // stop collar with its rubber ring, along the rod [mm]
collar_diameter = 34;     // [mm]
bumper_inside = 30;       // inner diameter of the rubber ring [mm]
bumper_thickness = 5;     // of the rubber ring, along the rod [mm]
magnet_diameter = 6.1;    // disc magnet of 6 x 3 mm [mm]
magnet_depth = 3.1;       // [mm]

handle_diameter = 32;     // [mm]
handle_length = 115;      // [mm]

$fa = 4;
$fs = 0.6;

bore = rod_diameter + rod_clearance;
along_rod = [0, 90, 0];  // parts are modelled with the rod along x, z up

module along_x(d, length, x = 0) {
  translate([x, 0, 0]) rotate(along_rod) cylinder(d = d, h = length);
}
