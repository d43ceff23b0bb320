# refuse.mk -- what Makefile.example refuses before anything runs, in one line each (build.md).
$(foreach g,$(MAKECMDGOALS),$(if $(findstring /,$g)$(filter all demo report $(UNPLANNED),$g),,$(error no goal '$g'; `make -f $(firstword $(MAKEFILE_LIST)) help` lists them)))
$(foreach v,SCENE OUT BIN ENVIRONMENT VOLUME,$(if $(word 2,$($v)),$(error $v='$($v)': make knows no names with blanks)))
$(if $(filter frames walkthrough auto,$(METHOD)),,$(error METHOD=$(METHOD): frames, walkthrough or auto))
$(if $(FILTER),$(if $(filter walkthrough auto,$(METHOD)),$(error FILTER=$(FILTER) with METHOD=$(METHOD): one or the other; leave METHOD out)))
$(if $(filter anew light records time auto,$(MOVING)),,$(error MOVING=$(MOVING): anew, light, records, time or auto))
$(if $(filter auto on off,$(SPLIT)),,$(error SPLIT=$(SPLIT): auto, on or off))
$(if $(filter gather textures,$(SURFACES)),,$(error SURFACES=$(SURFACES): gather or textures))
$(if $(filter draft final,$(QUALITY)),,$(error QUALITY=$(QUALITY): draft or final))
$(if $(shell echo '$(SIZE)' | grep -xE '[1-9][0-9]*x[1-9][0-9]*'),,$(error SIZE=$(SIZE): WIDTHxHEIGHT in pixels))
# A variable that nothing reads is a mistyped one: with scene=my.glb the demo would be rendered. Known are names in capitals that the makefiles hold, comments
# too (DESTDIR is cmake's), of others those that they expand, and what programs behind them take from the environment.
outside = SHELL CC CXX CFLAGS CXXFLAGS LDFLAGS CMAKE_% NINJA_% CCACHE_% TEMPOLUX_%
$(foreach v,$(.VARIABLES),$(if $(filter command,$(origin $v)),$(if $(filter $(outside),$v)$(shell case '$v' in (*[a-z]*) p='[$$][(]$v[:)]' ;; (*) p='\<$v\>' ;; esac; \
  grep -lE "$$p" $(MAKEFILE_LIST) $(pipelines)*.mk),,$(error $v=$($v): nothing reads $v; the first lines of $(firstword $(MAKEFILE_LIST)) have the names))))
