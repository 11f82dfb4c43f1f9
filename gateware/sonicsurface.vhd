-- One SonicSurface board: the makers' blocks, connected as in their block diagram QuadrupleBuffer.bdf. It is compiled twice,
-- with the blocks of the primary and with those of the secondary.
library ieee;
use ieee.std_logic_1164.all;

entity board is
    generic (taps : integer);
    port (
        clock : in std_logic;             -- 10.24 MHz from the makers' PLL
        serial : in std_logic;            -- MISC_B
        reset : in std_logic;             -- MISC_A of the secondary; ground in the primary
        count_high : out std_logic;       -- COUNT[7], on MISC_D of the primary
        pins : out std_logic_vector(255 downto 0)
    );
end entity;

architecture wired of board is
    signal count : std_logic_vector(7 downto 0);
    signal counter_reset, received, byte_ready, swap, swap_long, swap_late, set, set_long, set_late, clocks : std_logic;
    signal byte, phase, address : std_logic_vector(7 downto 0);
    signal data : std_logic_vector(31 downto 0);
    signal shift, latch : std_logic;
begin
    reset_filter : entity work.RSSFilter_1 generic map (taps) port map (clock, reset, counter_reset);
    serial_filter : entity work.RSSFilter_1 generic map (taps) port map (clock, serial, received);
    counter : entity work.Counter generic map (8) port map (clock, counter_reset, count);
    reader : entity work.UARTReader generic map (45) port map (clock, received, byte_ready, byte);
    distribute : entity work.Distribute port map (
        CLK => clock, byte_in => byte_ready, q_in => byte, swap_out => swap, set_out => set, multiplex_out => open,
        data_out => phase, address => address, debug_swap => open, debug_reset => open, debug_onShiftClocks => clocks);
    swap_expander : entity work.PulseExpander generic map (16) port map (clock, swap, swap_long);
    set_expander : entity work.PulseExpander generic map (16) port map (clock, set, set_long);
    swap_buffer : entity work.LatchBuffer port map (count(2), swap_long, swap_late);
    set_buffer : entity work.LatchBuffer port map (count(2), set_long, set_late);
    channels : entity work.AllChannels generic map (256) port map (
        clk8 => clock, clk => count(2), counter => count, swap => swap_late, phase => phase, set => set_late,
        address => address, data_out => data);
    count_high <= count(7);

    -- 32 shift registers 74HC595 of eight channels each. A bit that the multiplexer takes at count s is channel s of its eight.
    -- The latch comes with count 4, so the newest bit is channel 2 and the oldest channel 3.
    shift <= not clock and clocks;
    latch <= count(2) and clocks;
    registers : for chip in 0 to 31 generate
        signal shifted : std_logic_vector(7 downto 0) := x"00";
    begin
        process (shift) begin
            if rising_edge(shift) then
                shifted <= shifted(6 downto 0) & data(chip);
            end if;
        end process;
        process (latch) begin
            if rising_edge(latch) then
                -- Channels 7 to 0.
                pins(8 * chip + 7 downto 8 * chip) <= shifted(3) & shifted(4) & shifted(5) & shifted(6)
                    & shifted(7) & shifted(0) & shifted(1) & shifted(2);
            end if;
        end process;
    end generate;
end architecture;
