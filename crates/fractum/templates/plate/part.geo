// A plate of 200 x 100 mm with two holes, in mm: gmsh part.geo -2
SetFactory("OpenCASCADE");
h = 8;                                    // size of elements; 3.5 around the holes
Rectangle(1) = {0, 0, 0, 200, 100};
Disk(2) = {70, 40, 0, 12};
Disk(3) = {130, 60, 0, 12};
BooleanDifference(4) = { Surface{1}; Delete; }{ Surface{2, 3}; Delete; };
Physical Surface("plate") = {4};
Physical Curve("left") = Curve In BoundingBox {-1, -1, -1, 1, 101, 1};
Physical Curve("right") = Curve In BoundingBox {199, -1, -1, 201, 101, 1};
Mesh.Algorithm = 5;                       // Delaunay: no rows that cracks could follow
Field[1] = Box;
Field[1].VIn = 3.5; Field[1].VOut = h; Field[1].Thickness = 20;
Field[1].XMin = 50; Field[1].XMax = 150; Field[1].YMin = 0; Field[1].YMax = 100;
Background Field = 1;
Mesh.MeshSizeExtendFromBoundary = 0; Mesh.MeshSizeFromPoints = 0;
