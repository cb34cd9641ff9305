// Handle of a rod: ribs to grip, a blind bore, a cross hole for an M4 set screw and its nut.
include <dimensions.scad>

ribs = 8;
bore_depth = 70;  // [mm]

module handle() {
  difference() {
    along_x(handle_diameter, handle_length);
    along_x(rod_diameter + 0.2, bore_depth + 0.01, handle_length - bore_depth);
    for (i = [0:ribs - 1]) rotate([i * 360 / ribs, 0, 0]) translate([8, 0, handle_diameter / 2 + 2.5])
      rotate(along_rod) cylinder(d = 8, h = handle_length - 30);
    translate([handle_length - 10, 0, 0]) cylinder(d = 4.4, h = handle_diameter);
    // The nut's pocket opens into the bore.
    translate([handle_length - 10, 0, 0]) rotate([0, 0, 30])
      cylinder(d = 7.3 / cos(30), h = rod_diameter / 2 + 3.4, $fn = 6);
    translate([-0.01, 0, 0]) rotate(along_rod) difference() {
      cylinder(d = handle_diameter + 2, h = 3);
      cylinder(d1 = handle_diameter - 6, d2 = handle_diameter, h = 3);
    }
  }
}

rotate([0, -90, 0]) handle();
