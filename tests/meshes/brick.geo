// A brick of 3 x 2 x 1 m in 3 x 2 x 1 hexahedra. gmsh 4.8.4: gmsh -3 brick.geo -format msh41 [-bin] -o brick_41_text.msh
Point(1) = {0,0,0}; Extrude{3,0,0}{Point{1}; Layers{3};} Extrude{0,2,0}{Curve{1}; Layers{2}; Recombine;}
out[] = Extrude{0,0,1}{Surface{5}; Layers{1}; Recombine;};
Physical Volume("brick") = {1};
Physical Surface("zmin") = {5}; Physical Surface("zmax") = {out[0]};
