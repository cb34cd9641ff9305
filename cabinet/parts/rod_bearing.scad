// Plain bearing of a rod: a flange for the wall, a barrel that the sensor mount grips. Print it as it
// stands here, flange down, of PETG or nylon: the bore is then round, and the layers lie across the rod.
include <dimensions.scad>

wiper_width = 4;    // groove for a felt ring that keeps dust off the sensor [mm]
wiper_depth = 2;    // [mm]
chamfer = 1;        // of the bore's ends [mm]

// Rod along x; the wall's face is at x = 0.
module rod_bearing() {
  difference() {
    union() {
      translate([0, -flange_width / 2, -flange_width / 2]) rounded_plate(flange_thickness, flange_width, 6);
      along_x(barrel_diameter, flange_thickness + barrel_length);
      translate([flange_thickness, 0, 0]) rotate(along_rod)
        cylinder(d1 = barrel_diameter + 8, d2 = barrel_diameter, h = 4);
    }
    along_x(bore, flange_thickness + barrel_length + 2, -1);
    translate([-0.01, 0, 0]) rotate(along_rod) cylinder(d1 = bore + 2 * chamfer, d2 = bore, h = chamfer);
    translate([flange_thickness + barrel_length - chamfer + 0.01, 0, 0]) rotate(along_rod)
      cylinder(d1 = bore, d2 = bore + 2 * chamfer, h = chamfer);
    along_x(bore + 2 * wiper_depth, wiper_width, flange_thickness);
    for (y = [-1, 1], z = [-1, 1])
      translate([0, y * flange_hole_pitch / 2, z * flange_hole_pitch / 2]) {
        along_x(flange_hole, flange_thickness + 2, -1);
        translate([flange_thickness - 2.4, 0, 0]) rotate(along_rod)
          cylinder(d1 = flange_hole, d2 = flange_hole + 5, h = 2.41);
      }
  }
}

module rounded_plate(thickness, width, radius) {
  rotate([90, 0, 90]) linear_extrude(thickness) translate([radius, radius])
    offset(radius) square(width - 2 * radius);
}

rotate([0, -90, 0]) rod_bearing();
