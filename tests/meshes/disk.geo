// A quarter of a disk of radius 1 m in triangles. gmsh 4.8.4: gmsh -2 disk.geo -format msh41 [-bin] -o disk_41_text.msh
h = 0.25;
Point(1) = {0,0,0,h}; Point(2) = {1,0,0,h}; Point(3) = {0,1,0,h};
Line(1) = {1,2}; Circle(2) = {2,1,3}; Line(3) = {3,1};
Curve Loop(1) = {1,2,3}; Plane Surface(1) = {1};
Physical Surface("disk") = {1};
Physical Curve("bottom") = {1}; Physical Curve("left") = {3}; Physical Curve("rim") = {2};
