# Written by scene-plan; formats/plan/plan.md says what stands here.
stands/0000-41414df88d.photons stands/0000-41414df88d.paths: words := --frame 0 --map static --importance none --photons 700000 --kinds caustic,indirect
stands/0000-41414df88d.photons stands/0000-41414df88d.paths: |
stands_points/0000-481382b51c.irradpoints: words := --frame 0 --map static --photons stands/0000-41414df88d.photons --importance none
stands_points/0000-481382b51c.irradpoints: | stands/0000-41414df88d.photons
stands_cache/0000-58aee71fa3.irradcache: words := --frames 0,2,3,4,5,6,7,8,9,10,11,12,13,14,15,16,17,18,19,20,21,22,23 --map static --points stands_points/0000-481382b51c.irradpoints --size 640x360 --rays 500
stands_cache/0000-58aee71fa3.irradcache: | stands_points/0000-481382b51c.irradpoints
moved/0010-16b673fe46.photons: words := --frame 10 --map dynamic --static stands/0000-41414df88d.paths --importance none
moved/0010-16b673fe46.photons: | stands/0000-41414df88d.paths
points/0010-45239b2a85.irradpoints: words := --frame 10 --update stands_points/0000-481382b51c.irradpoints --photons stands/0000-41414df88d.photons --dynamic moved/0010-16b673fe46.photons --importance none
points/0010-45239b2a85.irradpoints: | stands_points/0000-481382b51c.irradpoints stands/0000-41414df88d.photons moved/0010-16b673fe46.photons
moved/0009-3298f667cb.photons: words := --frame 9 --map dynamic --static stands/0000-41414df88d.paths --importance none
moved/0009-3298f667cb.photons: | stands/0000-41414df88d.paths
moved/0008-5a1872b660.photons: words := --frame 8 --map dynamic --static stands/0000-41414df88d.paths --importance none
moved/0008-5a1872b660.photons: | stands/0000-41414df88d.paths
cache/0010-ca2f8e4526.irradcache: words := --frames 10 --update stands_cache/0000-58aee71fa3.irradcache --points points/0010-45239b2a85.irradpoints --dynamic moved/0010-16b673fe46.photons --dynamic moved/0009-3298f667cb.photons --dynamic moved/0008-5a1872b660.photons --size 640x360 --rays 500
cache/0010-ca2f8e4526.irradcache: | stands_cache/0000-58aee71fa3.irradcache points/0010-45239b2a85.irradpoints moved/0010-16b673fe46.photons moved/0009-3298f667cb.photons moved/0008-5a1872b660.photons
.INTERMEDIATE: raw/0010-39ab65b155.exr
raw/0010-39ab65b155.exr: words := --frame 10 --irradcache cache/0010-ca2f8e4526.irradcache --points points/0010-45239b2a85.irradpoints --photons stands/0000-41414df88d.photons --dynamic moved/0010-16b673fe46.photons --size 640x360 --spp 4 --pixel-error 0.016 --compression none --channels RGBA,layers,Z,N,id,albedo,coverage,halves,seen
raw/0010-39ab65b155.exr: | cache/0010-ca2f8e4526.irradcache points/0010-45239b2a85.irradpoints stands/0000-41414df88d.photons moved/0010-16b673fe46.photons
filtered/0010-fb00a708fd.exr: words := raw/0010-39ab65b155.exr --position 1 --channels RGBA,Z,N,id
filtered/0010-fb00a708fd.exr: | raw/0010-39ab65b155.exr
moved/0011-680d84315b.photons: words := --frame 11 --map dynamic --static stands/0000-41414df88d.paths --importance none
moved/0011-680d84315b.photons: | stands/0000-41414df88d.paths
points/0011-0801bddece.irradpoints: words := --frame 11 --update stands_points/0000-481382b51c.irradpoints --photons stands/0000-41414df88d.photons --dynamic moved/0011-680d84315b.photons --importance none
points/0011-0801bddece.irradpoints: | stands_points/0000-481382b51c.irradpoints stands/0000-41414df88d.photons moved/0011-680d84315b.photons
cache/0011-2604b81df4.irradcache: words := --frames 11 --update stands_cache/0000-58aee71fa3.irradcache --points points/0011-0801bddece.irradpoints --dynamic moved/0011-680d84315b.photons --dynamic moved/0010-16b673fe46.photons --dynamic moved/0009-3298f667cb.photons --size 640x360 --rays 500
cache/0011-2604b81df4.irradcache: | stands_cache/0000-58aee71fa3.irradcache points/0011-0801bddece.irradpoints moved/0011-680d84315b.photons moved/0010-16b673fe46.photons moved/0009-3298f667cb.photons
.INTERMEDIATE: raw/0011-8760277e28.exr
raw/0011-8760277e28.exr: words := --frame 11 --irradcache cache/0011-2604b81df4.irradcache --points points/0011-0801bddece.irradpoints --photons stands/0000-41414df88d.photons --dynamic moved/0011-680d84315b.photons --size 640x360 --spp 4 --pixel-error 0.016 --compression none --channels RGBA,layers,Z,N,id,albedo,coverage,halves,seen
raw/0011-8760277e28.exr: | cache/0011-2604b81df4.irradcache points/0011-0801bddece.irradpoints stands/0000-41414df88d.photons moved/0011-680d84315b.photons
filtered/0011-3354818367.exr: words := raw/0011-8760277e28.exr --position 1 --channels RGBA,Z,N,id
filtered/0011-3354818367.exr: | raw/0011-8760277e28.exr
moved/0012-8f0912c741.photons: words := --frame 12 --map dynamic --static stands/0000-41414df88d.paths --importance none
moved/0012-8f0912c741.photons: | stands/0000-41414df88d.paths
points/0012-1fc607895e.irradpoints: words := --frame 12 --update stands_points/0000-481382b51c.irradpoints --photons stands/0000-41414df88d.photons --dynamic moved/0012-8f0912c741.photons --importance none
points/0012-1fc607895e.irradpoints: | stands_points/0000-481382b51c.irradpoints stands/0000-41414df88d.photons moved/0012-8f0912c741.photons
cache/0012-01387b633c.irradcache: words := --frames 12 --update stands_cache/0000-58aee71fa3.irradcache --points points/0012-1fc607895e.irradpoints --dynamic moved/0012-8f0912c741.photons --dynamic moved/0011-680d84315b.photons --dynamic moved/0010-16b673fe46.photons --size 640x360 --rays 500
cache/0012-01387b633c.irradcache: | stands_cache/0000-58aee71fa3.irradcache points/0012-1fc607895e.irradpoints moved/0012-8f0912c741.photons moved/0011-680d84315b.photons moved/0010-16b673fe46.photons
.INTERMEDIATE: raw/0012-7605983a15.exr
raw/0012-7605983a15.exr: words := --frame 12 --irradcache cache/0012-01387b633c.irradcache --points points/0012-1fc607895e.irradpoints --photons stands/0000-41414df88d.photons --dynamic moved/0012-8f0912c741.photons --size 640x360 --spp 4 --pixel-error 0.016 --compression none --channels RGBA,layers,Z,N,id,albedo,coverage,halves,seen
raw/0012-7605983a15.exr: | cache/0012-01387b633c.irradcache points/0012-1fc607895e.irradpoints stands/0000-41414df88d.photons moved/0012-8f0912c741.photons
filtered/0012-033e6f49aa.exr: words := raw/0012-7605983a15.exr --position 1 --channels RGBA,Z,N,id
filtered/0012-033e6f49aa.exr: | raw/0012-7605983a15.exr
passing := raw/0010-39ab65b155.exr raw/0011-8760277e28.exr raw/0012-7605983a15.exr
frames := frames/0010.exr frames/0011.exr frames/0012.exr
previews := frames/0010.png frames/0011.png frames/0012.png
shown/exposure-27d6efea2c: | filtered/0010-fb00a708fd.exr
shown/0010-1c62a5d67e: | filtered/0010-fb00a708fd.exr; $(quiet)$(call show,0010,shown/0010-1c62a5d67e)
frames/0010.exr: | shown/0010-1c62a5d67e filtered/0010-fb00a708fd.exr; $(quiet)test -f $@ || { $(call show,0010,shown/0010-1c62a5d67e); }
shown/0010-5540de41eb.png: | filtered/0010-fb00a708fd.exr shown/exposure-27d6efea2c; $(quiet)$(call preview,0010,shown/0010-5540de41eb.png)
frames/0010.png: | shown/0010-5540de41eb.png filtered/0010-fb00a708fd.exr shown/exposure-27d6efea2c; $(quiet)test -f $@ || { $(call preview,0010,shown/0010-5540de41eb.png); }
shown/0011-f3d394e7ac: | filtered/0011-3354818367.exr; $(quiet)$(call show,0011,shown/0011-f3d394e7ac)
frames/0011.exr: | shown/0011-f3d394e7ac filtered/0011-3354818367.exr; $(quiet)test -f $@ || { $(call show,0011,shown/0011-f3d394e7ac); }
shown/0011-799c37d2b5.png: | filtered/0011-3354818367.exr shown/exposure-27d6efea2c; $(quiet)$(call preview,0011,shown/0011-799c37d2b5.png)
frames/0011.png: | shown/0011-799c37d2b5.png filtered/0011-3354818367.exr shown/exposure-27d6efea2c; $(quiet)test -f $@ || { $(call preview,0011,shown/0011-799c37d2b5.png); }
shown/0012-32d8bf4284: | filtered/0012-033e6f49aa.exr; $(quiet)$(call show,0012,shown/0012-32d8bf4284)
frames/0012.exr: | shown/0012-32d8bf4284 filtered/0012-033e6f49aa.exr; $(quiet)test -f $@ || { $(call show,0012,shown/0012-32d8bf4284); }
shown/0012-bb7d3b15cf.png: | filtered/0012-033e6f49aa.exr shown/exposure-27d6efea2c; $(quiet)$(call preview,0012,shown/0012-bb7d3b15cf.png)
frames/0012.png: | shown/0012-bb7d3b15cf.png filtered/0012-033e6f49aa.exr shown/exposure-27d6efea2c; $(quiet)test -f $@ || { $(call preview,0012,shown/0012-bb7d3b15cf.png); }
shown/sheet-ca675f956d: | shown/exposure-27d6efea2c $(log) $(frames) shown/0010-1c62a5d67e shown/0011-f3d394e7ac shown/0012-32d8bf4284; $(quiet)$(call sheet,shown/sheet-ca675f956d)
sheet.png: | shown/sheet-ca675f956d shown/exposure-27d6efea2c $(log) $(frames) shown/0010-1c62a5d67e shown/0011-f3d394e7ac shown/0012-32d8bf4284; $(quiet)test -f $@ || { $(call sheet,shown/sheet-ca675f956d); }
