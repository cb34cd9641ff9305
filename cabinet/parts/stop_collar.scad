// Stop at a rod's end: clamps the rod by one M3 screw and carries a rubber ring that meets the bearing.
// It stops the rod, and is where the program's rod stops: set it by the table of travels. The pocket takes
// a disc magnet, the index mark of the inner collar: its switch stands on the rail.
include <dimensions.scad>

body = collar_width - bumper_thickness;
seat = bumper_thickness - 1;  // the rubber stands beyond it, and is what meets the bearing [mm]
stretch = 0.4;                // of the rubber on its seat, which holds it there [mm]

module stop_collar() {
  difference() {
    union() {
      along_x(collar_diameter, body);
      along_x(bumper_inside + stretch, body + seat);
    }
    along_x(rod_diameter + 0.15, collar_width + 2, -1);
    translate([body / 2, 0, collar_diameter / 2 - magnet_depth])
      cylinder(d = magnet_diameter, h = magnet_depth + 1);
    translate([-1, -clamp_slit / 2, -collar_diameter]) cube([collar_width + 2, clamp_slit, collar_diameter]);
    translate([body / 2, 0, -rod_diameter / 2 - 4.5]) rotate([90, 0, 0]) {
      cylinder(d = screw, h = 60, center = true);
      translate([0, 0, 6]) cylinder(d = nut_width / cos(30), h = 20, $fn = 6);
      translate([0, 0, -26]) cylinder(d = 6.2, h = 20);
    }
  }
}

module rubber_ring() difference() {
  along_x(bumper_inside + 10, bumper_thickness, body);
  along_x(bumper_inside + stretch, bumper_thickness + 2, body - 1);
}

rotate([0, -90, 0]) stop_collar();
