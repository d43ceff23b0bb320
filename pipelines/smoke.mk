# smoke.mk -- part of Makefile.example, taken where scene-plan has found media (plan_media): smoke is put into the frames last.
# Frames before it are in OUT/clear; what comes through the smoke is dimmed there already.
# Points: for phase functions with a peak, where rays from the eye end.
smoke_points = $(if $(textured),,$(photons_$*:%=$(OUT)/points/%.irradpoints))
$(pictures): $(OUT)/frames/%.exr: $(OUT)/clear/%.exr $$(photons_$$*:%=$(OUT)/photons/%.photons) $$(smoke_points) $(OUT)/options/smoke $(BIN)/volume-compose
	$(RUN) $(BIN)/volume-compose $(SCENE) --frame $* --base $< --photons $(OUT)/photons/$(photons_$*).photons $(addprefix --points ,$(smoke_points)) \
	  $(options_smoke) -o $@ --stats $(@:.exr=.json)

# SURFACES=textures: indirect light of the surfaces as the smoke has it, photons counted in elements and smoothed, in place of points and cache.
ifneq ($(filter textures,$(SURFACES)),)
$(plan_photons:%=$(OUT)/textures/%.meshirrad): $(OUT)/textures/%.meshirrad: $(OUT)/photons/%.photons $(OUT)/options/textures $(BIN)/st-filter
	$(RUN) $(BIN)/st-filter mesh $(SCENE) --frame $* --photons $< $(options_textures) -o $@ --stats $(@:.meshirrad=.json)
endif
